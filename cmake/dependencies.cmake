# Everything Burin stands on, as Debian packages it (tools/packages.txt lists the package names).
find_package(Threads REQUIRED)
find_package(Eigen3 3.4 REQUIRED NO_MODULE)
find_package(TBB REQUIRED)
find_package(nlohmann_json 3.11 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(OpenImageIO REQUIRED)
find_package(embree REQUIRED)  # 3 or 4 (burin/render/embree_rays.h)
find_package(OpenCV 4 REQUIRED COMPONENTS core imgproc calib3d features2d)
find_package(Ceres 2.1 REQUIRED)
find_package(xsimd REQUIRED)
# Debian's xsimd asks to link xtl for complex numbers; there is no such library to link, and we have no complex numbers.
set_property(TARGET xsimd PROPERTY INTERFACE_LINK_LIBRARIES "")
find_package(ZLIB REQUIRED)
find_package(PkgConfig REQUIRED)
pkg_check_modules(apriltag REQUIRED IMPORTED_TARGET apriltag)

# mrcal ships neither a CMake config nor a .pc file.
find_path(mrcal_INCLUDE_DIR mrcal/mrcal.h REQUIRED)
find_library(mrcal_LIBRARY mrcal REQUIRED)
if(NOT TARGET mrcal::mrcal)
  add_library(mrcal::mrcal UNKNOWN IMPORTED)
  set_target_properties(mrcal::mrcal PROPERTIES IMPORTED_LOCATION "${mrcal_LIBRARY}"
                                                INTERFACE_INCLUDE_DIRECTORIES "${mrcal_INCLUDE_DIR}")
endif()
