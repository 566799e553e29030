// burin/pictures/hevc_decoder.h - HEVC decoder for libheif that reports libde265's warnings.
#pragma once

namespace burin {

/// Makes libheif decode HEVC (HEIC) with libde265 through this module. libheif's own plug-in drops libde265's warnings
/// of damaged data and returns any output. One call serves the whole program and all threads.
void use_hevc_decoder();

}  // namespace burin
