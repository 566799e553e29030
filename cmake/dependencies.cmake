# Everything Burin stands on, as Debian packages it (tools/packages.txt lists the package names). Read when Burin is built, and
# by find_package(burin) in projects that use it.
include(${CMAKE_CURRENT_LIST_DIR}/burin_needs.cmake)

burin_needs(Threads "threads" build-essential https://cmake.org/cmake/help/latest/module/FindThreads.html)
burin_needs(Eigen3 "Eigen 3.4 or newer" libeigen3-dev https://eigen.tuxfamily.org LEAST 3.4 NO_MODULE)
burin_needs(TBB "oneTBB" libtbb-dev https://uxlfoundation.github.io/oneTBB)
if(BURIN_CORE)  # boards of meshes, where it is there
  find_package(embree QUIET)
  return()
endif()
burin_needs(OpenImageIO "OpenImageIO" libopenimageio-dev https://openimageio.readthedocs.io)
burin_needs(embree "Embree 3 or 4" libembree-dev https://www.embree.org)  # scene/embree_rays.h
burin_needs(Ceres "Ceres Solver 2.1 or newer" libceres-dev http://ceres-solver.org/installation.html 2.1)
if(Ceres_FOUND)
  burin_needs_what_links(Ceres::ceres "Ceres Solver" libceres-dev http://ceres-solver.org/installation.html)
endif()
burin_needs(ZLIB "zlib" zlib1g-dev https://zlib.net)
burin_needs(PkgConfig "pkg-config" pkg-config https://www.freedesktop.org/wiki/Software/pkg-config)
burin_needs(apriltag "AprilTag 3" libapriltag-dev https://github.com/AprilRobotics/apriltag MODULE apriltag)
burin_needs(heif "libheif" libheif-dev https://github.com/strukturag/libheif MODULE libheif)
burin_needs(de265 "libde265" libde265-dev https://github.com/strukturag/libde265 MODULE libde265)
burin_needs(lcms2 "Little CMS 2" liblcms2-dev https://www.littlecms.com MODULE lcms2)
burin_needs(JPEG "libjpeg" libjpeg-dev https://libjpeg-turbo.org)

# What OpenCV 4 calls calib3d, 5 has in parts.
find_package(OpenCV QUIET)
set(burin_views_of_opencv geometry calib objdetect)
if(OpenCV_FOUND AND OpenCV_VERSION VERSION_LESS 5)
  set(burin_views_of_opencv calib3d)
endif()
burin_needs(OpenCV "OpenCV 4 or 5 with its calibration" libopencv-dev https://docs.opencv.org LEAST 4
            COMPONENTS core imgproc ${burin_views_of_opencv})
list(TRANSFORM burin_views_of_opencv PREPEND opencv_)
if(NOT TARGET burin_opencv::calib3d)
  add_library(burin_opencv::calib3d INTERFACE IMPORTED)
  set_target_properties(burin_opencv::calib3d PROPERTIES INTERFACE_LINK_LIBRARIES "${burin_views_of_opencv}")
endif()

# mrcal ships neither a CMake config nor a .pc file.
if(NOT TARGET mrcal::mrcal)
  find_path(mrcal_INCLUDE_DIR mrcal/mrcal.h)
  find_library(mrcal_LIBRARY mrcal)
  if(mrcal_INCLUDE_DIR AND mrcal_LIBRARY)
    add_library(mrcal::mrcal UNKNOWN IMPORTED)
    set_target_properties(mrcal::mrcal PROPERTIES IMPORTED_LOCATION "${mrcal_LIBRARY}"
                                                  INTERFACE_INCLUDE_DIRECTORIES "${mrcal_INCLUDE_DIR}")
  else()
    burin_lacks("mrcal 2.2 or newer" libmrcal-dev https://mrcal.secretsauce.net/install.html)
  endif()
endif()
