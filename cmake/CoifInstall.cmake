# install + find_package(coif): one static library a room, headers as they stand.
include(CMakePackageConfigHelpers)
get_property(rooms GLOBAL PROPERTY COIF_ROOMS)
# Third parties that the static libraries need when somebody else links them.
set(third_parties coif_3rd_openmesh coif_3rd_opensubdiv coif_3rd_lz4 coif_3rd_tinygltf)
if(COIF_WITH_PREVIEW)
  list(APPEND third_parties coif_3rd_epoxy)
endif()
if(COIF_WITH_EMBREE)
  list(APPEND third_parties coif_3rd_embree)
endif()
install(TARGETS ${rooms} ${third_parties} EXPORT coifTargets ARCHIVE DESTINATION ${CMAKE_INSTALL_LIBDIR})
install(DIRECTORY ${PROJECT_SOURCE_DIR}/include/coif DESTINATION ${CMAKE_INSTALL_INCLUDEDIR})
install(EXPORT coifTargets NAMESPACE coif:: DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coif)
configure_package_config_file(${CMAKE_CURRENT_LIST_DIR}/coifConfig.cmake.in ${PROJECT_BINARY_DIR}/coifConfig.cmake
  INSTALL_DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coif)
write_basic_package_version_file(${PROJECT_BINARY_DIR}/coifConfigVersion.cmake COMPATIBILITY SameMajorVersion)
install(FILES ${PROJECT_BINARY_DIR}/coifConfig.cmake ${PROJECT_BINARY_DIR}/coifConfigVersion.cmake
  DESTINATION ${CMAKE_INSTALL_LIBDIR}/cmake/coif)
