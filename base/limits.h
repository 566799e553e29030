// burin/base/limits.h - upper limits of input sizes. docs/limits.md has the memory and time of each.
//
// Readers check a limit before they allocate memory for the content. The message of a refusal names the limit and the
// remedy. The limits are far above practical boards. Within them, no command needs more than 4 GB.
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
constexpr std::uintmax_t kPictureHeadBytes = 16 * kMiB;  ///< bytes searched for a picture's size

constexpr std::size_t kMeshLineBytes = kMiB;  ///< a line of an OBJ

// Pixels.
constexpr std::int64_t kPhotoPixels = 110'000'000;    ///< a photo, and the camera of a setup or a ground truth
constexpr std::int64_t kBracketPixels = 200'000'000;  ///< all exposures of one view under one lamp together
constexpr std::int64_t kPicturePixels = 1LL << 28;    ///< a target picture: 16,384 x 16,384
constexpr std::int64_t kDesignPixels = 70'000'000;    ///< all views of a design together: 100 of 800 x 800
constexpr int kPictureSide = 100'000;                 ///< width or height of a target picture
constexpr int kPhotoSide = 32'767;                    ///< of a photo: AprilTag counts pixels by 15 bits
constexpr int kJpegScans = 500;                       ///< of a progressive JPEG: each scan covers all of its pixels
constexpr double kJpegScanPixels = 5e9;               ///< pixels in all scans of one JPEG together
constexpr int kChannels = 16;                         ///< values of a picture's pixel; Burin uses three, and alpha
constexpr std::int64_t kTileBytes = 256 * (1 << 20);  ///< a tile or a strip of a file

// Counts.
constexpr int kNesting = 100;             ///< brackets within brackets, in JSON
constexpr std::size_t kScratches = 1e7;   ///< rows of a scratches.csv; random scratches of a ground truth
constexpr std::size_t kCuts = 5'000'000;  ///< pieces beyond the number of scratches, if grooves cut each other
constexpr std::size_t kNear = 1e8;        ///< pairs of near scratches
constexpr std::size_t kColumns = 1'000;   ///< of a table
constexpr std::size_t kTriangles = 2e6;   ///< of a mesh, after its faces are cut; its vertices as well
constexpr std::size_t kTags = 2'000;      ///< of a board
constexpr std::size_t kViews = 500;       ///< of a setup, a design or a ground truth
constexpr std::size_t kLights = 100;      ///< of a setup or a ground truth
constexpr std::size_t kPhotos = 5'000;    ///< of a session, or in a folder
constexpr std::size_t kHeights = 40'000;  ///< points of a height map
constexpr std::size_t kKeepOut = 10'000;  ///< keep-outs of a board
constexpr double kBoard_mm = 100'000;     ///< a board's width or height
constexpr int kLeastPhotoSide = 16;       ///< px: smaller photos show no tag
constexpr std::size_t kDust = 1'000'000;  ///< specks, and fibers, of a ground truth
constexpr int kSamples = 65'536;          ///< points per pixel of a ground truth

}  // namespace burin::limit
