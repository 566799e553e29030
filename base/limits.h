// burin/base/limits.h - how much of anything Burin takes in. What each costs in memory and time: docs/limits.md.
//
// Checked where a file is read, before memory is taken for what it asks; what is above is refused in a sentence that
// names the limit and says how to go on. They lie well above what a board of metal and a person's patience hold, and so
// that no command needs more than 4 GB for what is within them.
#pragma once

#include <cstddef>
#include <cstdint>

namespace burin::limit {

constexpr std::uintmax_t kKiB = 1024, kMiB = 1024 * kKiB, kGiB = 1024 * kMiB;

// Bytes of a file.
constexpr std::uintmax_t kJsonBytes = 32 * kMiB;         ///< board, bench, session, ...: 2,000 photos take 0.5 MiB
constexpr std::uintmax_t kTomlBytes = kMiB;              ///< a machine's profile, a project's options
constexpr std::uintmax_t kLensBytes = 4 * kMiB;          ///< a .cameramodel
constexpr std::uintmax_t kTableBytes = kGiB;             ///< scratches.csv, residuals, corners: kScratches take 0.5 GiB
constexpr std::uintmax_t kGcodeBytes = kGiB;             ///< G-code to be replayed, and any other text
constexpr std::uintmax_t kMeshBytes = 256 * kMiB;        ///< an OBJ
constexpr std::uintmax_t kPictureBytes = 4 * kGiB;       ///< a photo or a picture
constexpr std::uintmax_t kPictureHeadBytes = 16 * kMiB;  ///< what is looked through for a picture's size

constexpr std::size_t kMeshLineBytes = kMiB;  ///< a line of it

// Pixels.
constexpr std::int64_t kPhotoPixels = 110'000'000;    ///< a photo, and what a camera of a bench or a truth has
constexpr std::int64_t kBracketPixels = 200'000'000;  ///< all exposures of one view under one lamp together
constexpr std::int64_t kPicturePixels = 1LL << 28;    ///< a picture to be shown: 16,384 x 16,384
constexpr std::int64_t kDesignPixels = 70'000'000;    ///< of all views of a design: 100 of 800 x 800
constexpr int kPictureSide = 100'000;                 ///< width or height of a picture to be shown
constexpr int kPhotoSide = 32'767;                    ///< of a photo: AprilTag counts pixels by 15 bits
constexpr int kJpegScans = 500;                       ///< of a progressive JPEG: each goes over all of its pixels
constexpr double kJpegScanPixels = 5e9;               ///< pixels that all scans of one go over
constexpr int kChannels = 16;                         ///< of a picture's pixel; what is used are three, and alpha
constexpr std::int64_t kTileBytes = 256 * (1 << 20);  ///< a tile or a strip that a file is cut into

// How many.
constexpr int kNesting = 100;             ///< brackets within brackets, in JSON
constexpr std::size_t kScratches = 1e7;   ///< rows of a scratches.csv; random ones in a truth
constexpr std::size_t kCuts = 5'000'000;  ///< pieces more than scratches, where grooves are cut by one another
constexpr std::size_t kNear = 1e8;        ///< times that a scratch lies near another, where pairs are looked at
constexpr std::size_t kColumns = 1'000;   ///< of a table
constexpr std::size_t kTriangles = 2e6;   ///< of a mesh, after its faces are cut; its vertices as well
constexpr std::size_t kTags = 2'000;      ///< of a board
constexpr std::size_t kViews = 500;       ///< of a bench, a design or a truth
constexpr std::size_t kLights = 100;      ///< of a bench or a truth
constexpr std::size_t kPhotos = 5'000;    ///< of a session, or in a folder
constexpr std::size_t kHeights = 40'000;  ///< points of a height map
constexpr std::size_t kKeepOut = 10'000;  ///< places that nothing is carved on
constexpr double kBoard_mm = 100'000;     ///< a board's width or height
constexpr int kLeastPhotoSide = 16;       ///< px: no tag is found in less
constexpr std::size_t kDust = 1'000'000;  ///< specks, and fibers, of a truth
constexpr int kSamples = 65'536;          ///< points a pixel of a truth

}  // namespace burin::limit
