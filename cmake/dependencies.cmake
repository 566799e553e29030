# Everything Burin stands on, as Debian packages it (tools/packages.txt lists the package names). Read when Burin is built, and
# by find_package(burin) in projects that use it, where `burin_needs` is find_dependency: what is missing is said in the user's
# own terms, and QUIET and REQUIRED are passed on.
macro(burin_needs)
  if(COMMAND find_dependency)
    find_dependency(${ARGV})
  else()
    find_package(${ARGV} REQUIRED)
  endif()
endmacro()

burin_needs(Threads)
burin_needs(Eigen3 3.4 NO_MODULE)
burin_needs(TBB)
burin_needs(OpenImageIO)
burin_needs(embree)  # 3 or 4 (burin/render/embree_rays.h)
burin_needs(OpenCV 4 COMPONENTS core imgproc calib3d features2d)
burin_needs(Ceres 2.1)
burin_needs(ZLIB)
burin_needs(PkgConfig)
if(NOT TARGET PkgConfig::apriltag)
  pkg_check_modules(apriltag REQUIRED IMPORTED_TARGET apriltag)
endif()
if(NOT TARGET PkgConfig::heif)
  pkg_check_modules(heif REQUIRED IMPORTED_TARGET libheif)
endif()
if(NOT TARGET PkgConfig::lcms2)
  pkg_check_modules(lcms2 REQUIRED IMPORTED_TARGET lcms2)
endif()

# mrcal ships neither a CMake config nor a .pc file.
if(NOT TARGET mrcal::mrcal)
  find_path(mrcal_INCLUDE_DIR mrcal/mrcal.h REQUIRED)
  find_library(mrcal_LIBRARY mrcal REQUIRED)
  add_library(mrcal::mrcal UNKNOWN IMPORTED)
  set_target_properties(mrcal::mrcal PROPERTIES IMPORTED_LOCATION "${mrcal_LIBRARY}"
                                                INTERFACE_INCLUDE_DIRECTORIES "${mrcal_INCLUDE_DIR}")
endif()
