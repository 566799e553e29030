// Nothing: CMake wants a file for the target whose precompiled headers the tests share.
