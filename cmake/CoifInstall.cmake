# install + find_package(coif): one static library a room.
include(CMakePackageConfigHelpers)
