// tools/rounds_quality.h - how near a project's boards come to their pictures, round after round, and whether another
// board is worth its hours. PROJECT/rounds.json, written with the project's report.html (docs/file-formats.md).
#pragma once

#include <filesystem>
#include <limits>
#include <optional>
#include <string>
#include <vector>

namespace burin {

/// PSNR of one picture in one round, dB; not a number where there is none.
struct ViewQuality {
  std::string view;
  double promised_db = std::numeric_limits<double>::quiet_NaN();      ///< by the bench that it was designed for
  double photographed_db = std::numeric_limits<double>::quiet_NaN();  ///< by a photo from the view's place
};

/// The pictures of each round, the first round first; all rounds have the same views in the same order.
using RoundsQuality = std::vector<std::vector<ViewQuality>>;

/// The text of a rounds.json; and the file read. Nothing where it is not there. Throws Error for a broken one.
std::string rounds_text(const RoundsQuality& rounds, const std::filesystem::path& file);
std::optional<RoundsQuality> read_rounds(const std::filesystem::path& file);

/// The last board that was photographed, beside the one that is designed next: means over all pictures, dB.
struct NextBoard {
  int round = 0;  ///< the photographed one's
  double promised_db = 0, photographed_db = 0, next_db = 0;
  double most_gain_db = 0;  ///< of the picture that gains most

  double gain_db() const { return next_db - photographed_db; }
};

/// Nothing where a picture of either board lacks its figure.
std::optional<NextBoard> next_board(const RoundsQuality& rounds);

/// The gain, dB, below which two pictures look alike. The committees that made the MPEG formats took 0.5 dB for the
/// least that is seen (D. Salomon, Data Compression: The Complete Reference, 4th edition, 2007, section 4.2.2).
inline constexpr double kSeen_db = 0.5;

/// Whether the photographed board is as good as the bench lets one be: it shows what was promised, and the next one
/// would gain less than is seen, and no picture of it twice that.
bool is_last(const NextBoard& next);

/// "hang the board of round 2: it shows 26.9 dB, 27.2 dB were promised, and another board would gain 0.4 dB, which
/// nobody sees".
std::string hang_in_words(const NextBoard& next);

}  // namespace burin
