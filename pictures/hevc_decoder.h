// burin/pictures/hevc_decoder.h - libheif's decoder of HEVC, with libde265's warnings heard.
#pragma once

namespace burin {

/// Has libheif decode HEVC (HEIC) by libde265 through us from now on, in the place of its own way to libde265, which
/// drops what that says of damaged data and hands out whatever came of them. Once for the whole program; for any
/// thread.
void use_hevc_decoder();

}  // namespace burin
