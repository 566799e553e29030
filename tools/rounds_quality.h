// tools/rounds_quality.h - quality of a project's boards, round by round, and the decision about another board.
// PROJECT/rounds.json, written with the project's report.html (docs/file-formats.md).
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace burin {

/// PSNR of one picture in one round, dB; NaN if missing.
struct ViewQuality {
  std::string view;
  double promised_db = std::numeric_limits<double>::quiet_NaN();      ///< by the bench of its design
  double photographed_db = std::numeric_limits<double>::quiet_NaN();  ///< by a photo from the viewpoint
};

/// The pictures of each round, in order. All rounds have the same views in the same order.
using RoundsQuality = std::vector<std::vector<ViewQuality>>;

/// Writes the text of a rounds.json, and reads the file. Returns nothing for a missing file. Throws Error for a broken
/// one.
std::string rounds_text(const RoundsQuality& rounds, const std::filesystem::path& file);
std::optional<RoundsQuality> read_rounds(const std::filesystem::path& file);

/// The latest photographed board and the next designed one: means over all pictures, dB.
struct NextBoard {
  int round = 0;  ///< of the photographed board
  double promised_db = 0, photographed_db = 0, next_db = 0;
  double most_gain_db = 0;  ///< of the picture with the largest gain

  double gain_db() const { return next_db - photographed_db; }
};

/// Returns nothing if a picture of either board has no figure.
std::optional<NextBoard> next_board(const RoundsQuality& rounds);

/// Gain in dB below which two pictures look alike. The MPEG committees took 0.5 dB as the smallest visible difference
/// (D. Salomon, Data Compression: The Complete Reference, 4th edition, 2007, section 4.2.2).
inline constexpr double kSeen_db = 0.5;

/// Returns true if the photographed board cannot improve visibly on this bench. It must reach its prediction within
/// kSeen_db. The next board must gain less than kSeen_db on average and less than twice as much in any picture.
bool is_last(const NextBoard& next);

/// Returns a sentence that recommends the photographed board, with its PSNR, its prediction and the gain of another
/// board.
std::string hang_in_words(const NextBoard& next);

}  // namespace burin
