# coif_room(NAME [ROOMS room...] [PUBLIC lib...] [PRIVATE lib...] [HEADERS lib...])
# One static library coif_NAME (alias coif::NAME) from every source below src/NAME.
# HEADERS: third parties of headers alone, which a user of the installed library does not need.
add_library(coif_options INTERFACE)
target_compile_options(coif_options INTERFACE
  $<BUILD_INTERFACE:-Wall -Wextra -Wpedantic -Wshadow -Wnon-virtual-dtor -ffp-contract=off>)

function(coif_room NAME)
  cmake_parse_arguments(ROOM "" "" "ROOMS;PUBLIC;PRIVATE;HEADERS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${CMAKE_CURRENT_SOURCE_DIR}/*.cpp)
  add_library(coif_${NAME} STATIC ${sources})
  add_library(coif::${NAME} ALIAS coif_${NAME})
  set_target_properties(coif_${NAME} PROPERTIES EXPORT_NAME ${NAME})
  target_include_directories(coif_${NAME}
    PUBLIC $<BUILD_INTERFACE:${PROJECT_SOURCE_DIR}/include> $<INSTALL_INTERFACE:${CMAKE_INSTALL_INCLUDEDIR}>
    PRIVATE ${PROJECT_SOURCE_DIR}/src)
  target_compile_features(coif_${NAME} PUBLIC cxx_std_20)  # for those who link the installed room
  list(TRANSFORM ROOM_ROOMS PREPEND coif::)
  foreach(header_library ${ROOM_HEADERS})
    target_link_libraries(coif_${NAME} PRIVATE $<BUILD_INTERFACE:${header_library}>)
  endforeach()
  target_link_libraries(coif_${NAME} PUBLIC ${ROOM_ROOMS} ${ROOM_PUBLIC} PRIVATE ${ROOM_PRIVATE} $<BUILD_INTERFACE:coif_options>)
  set_property(GLOBAL APPEND PROPERTY COIF_ROOMS coif_${NAME})
endfunction()

# coif_test(ROOM [LIBS lib...]): one GoogleTest program from every source below tests/ROOM.
function(coif_test ROOM)
  cmake_parse_arguments(TEST "" "" "LIBS" ${ARGN})
  file(GLOB_RECURSE sources CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/tests/${ROOM}/*.cpp)
  if(NOT sources)
    return()
  endif()
  add_executable(test_${ROOM} ${sources})
  target_include_directories(test_${ROOM} PRIVATE ${PROJECT_SOURCE_DIR}/tests ${PROJECT_SOURCE_DIR}/src)
  target_link_libraries(test_${ROOM} PRIVATE coif::${ROOM} ${TEST_LIBS} coif_options GTest::gtest_main)
  target_compile_definitions(test_${ROOM} PRIVATE
    COIF_SOURCE_DIR="${PROJECT_SOURCE_DIR}" COIF_SHARED_DATA="${PROJECT_SOURCE_DIR}/../shared/data")
  gtest_discover_tests(test_${ROOM} TEST_PREFIX "${ROOM}." DISCOVERY_TIMEOUT 60 PROPERTIES TIMEOUT 900)
endfunction()
