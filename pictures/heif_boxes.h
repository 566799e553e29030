// burin/pictures/heif_boxes.h - what libheif does not tell of a HEIF file, read from its boxes by hand
// (ISO/IEC 14496-12, 23008-12).
#pragma once

#include <cstdint>
#include <string>

#include "burin/pictures/picture_bytes.h"

namespace burin {

/// The part of the coded picture that is meant to be shown, in its pixels. The rest is filling.
struct HeifCrop {
  int left = 0, top = 0, width = 0, height = 0;
};

struct HeifBoxes {
  std::int64_t width = 0, height = 0;  ///< the largest that is named ("ispe"): a tile's or the whole's
  bool moves = false;                  ///< a sequence of pictures
};

/// Walks the file's boxes. Throws Error for one that is longer than the file, and for a file that names no size.
HeifBoxes read_heif_boxes(PictureBytes& file);

/// The main picture as it is coded, neither turned nor mirrored: its "clap", or all of the size that is named.
HeifCrop heif_crop(PictureBytes& file, int named_width, int named_height);

}  // namespace burin
