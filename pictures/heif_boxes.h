// burin/pictures/heif_boxes.h - properties of a HEIF file that libheif does not expose, read from its boxes (ISO/IEC
// 14496-12, 23008-12).
#pragma once

#include <cstdint>
#include <string>

#include "burin/pictures/picture_bytes.h"

namespace burin {

/// The displayed part of the coded picture, in its pixels. The rest is padding.
struct HeifCrop {
  int left = 0, top = 0, width = 0, height = 0;
};

struct HeifBoxes {
  std::int64_t width = 0, height = 0;  ///< largest declared size ("ispe"): of a tile or of the whole
  bool moves = false;                  ///< a sequence of pictures
};

/// Walks the file's boxes. Throws Error for a box longer than the file, and for a file without a declared size.
HeifBoxes read_heif_boxes(PictureBytes& file);

/// The main picture as coded, neither rotated nor mirrored: its "clap", or the whole declared size.
HeifCrop heif_crop(PictureBytes& file, int named_width, int named_height);

}  // namespace burin
