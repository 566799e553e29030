# Libraries of headers alone, which only Burin's own .cpp files include: those who use Burin need none of them.
burin_needs(nlohmann_json "JSON for Modern C++ 3.11 or newer" nlohmann-json3-dev https://json.nlohmann.me 3.11)
burin_needs(tomlplusplus "toml++ 3.3 or newer" libtomlplusplus-dev https://marzer.github.io/tomlplusplus 3.3)
burin_needs(xsimd "xsimd" libxsimd-dev https://xsimd.readthedocs.io)
burin_settle_needs()  # the libraries', too
# Debian's xsimd asks to link xtl for complex numbers; there is no such library to link, and we have no complex numbers.
add_library(burin_xsimd INTERFACE)
target_include_directories(burin_xsimd SYSTEM INTERFACE $<TARGET_PROPERTY:xsimd,INTERFACE_INCLUDE_DIRECTORIES>)
