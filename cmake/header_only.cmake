# Libraries of headers alone, which only Burin's own .cpp files include: those who use Burin need none of them.
find_package(nlohmann_json 3.11 REQUIRED)
find_package(tomlplusplus 3.3 REQUIRED)
find_package(xsimd REQUIRED)
# Debian's xsimd asks to link xtl for complex numbers; there is no such library to link, and we have no complex numbers.
add_library(burin_xsimd INTERFACE)
target_include_directories(burin_xsimd SYSTEM INTERFACE $<TARGET_PROPERTY:xsimd,INTERFACE_INCLUDE_DIRECTORIES>)
