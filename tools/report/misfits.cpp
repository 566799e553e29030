#include "tools/report/misfits.h"

#include <fmt/format.h>

#include <array>
#include <vector>

#include "burin/base/files/decimals.h"
#include "tools/report/chart.h"
#include "tools/report/html.h"

namespace burin {
namespace {

std::string picture_of(const Misfit& misfit) {
  Curve mean{"photos less model", {}}, above{"one sigma more", {}, true}, below{"one sigma less", {}, true};
  for (const Misfit::Class& c : misfit.classes) {
    mean.values.push_back(100 * c.residual);
    above.values.push_back(100 * (c.residual + c.sigma));
    below.values.push_back(100 * (c.residual - c.sigma));
  }
  const std::array<Curve, 3> curves{mean, above, below};
  ChartWords words;
  words.x_label = "pixels in groups, by " + quantity_in_words(misfit);
  words.y_label = "% of the light";
  words.description = "Photos minus model, in percent, by " + quantity_in_words(misfit);
  for (const Misfit::Class& c : misfit.classes) words.x_names.push_back(c.name);
  words.marks = true;
  words.of_dashed = "one sigma of the mean";
  return chart(curves, words);
}

}  // namespace

std::string misfits_in_pictures(const Bench& bench) {
  if (bench.misfits.empty()) return "";
  std::string inside =
      "<p>Pixels are grouped by something that an effect which nobody modeled would set apart. Each group by itself "
      "asks for another bench; half of what lies between these answers is counted in the sigmas above.</p>\n";
  std::string names;
  for (const Misfit& m : bench.misfits) {
    names += (names.empty() ? "" : ", ") + m.test;
    const std::string off =
        fmt::format("alpha by {} %, depth by {} %, base_alpha by {} %", significant(m.alpha_percent),
                    significant(m.depth_percent), significant(m.base_alpha_percent));
    const std::string apart =
        is_of_photo(m) ? fmt::format("Its residuals are {} times the others&#39;; without it the answer moves",
                                     significant(m.sigmas))
                       : fmt::format("The groups&#39; answers differ by {} sigmas; half of what lies between them",
                                     significant(m.sigmas));
    inside += fmt::format("<h4>By {}</h4>\n<p>{}: {}. What usually helps: {}.</p>\n{}", html(quantity_in_words(m)),
                          apart, off, html(remedy_in_words(m)), picture_of(m));
  }
  return folded("Where the model is not enough", html(names), inside);
}

}  // namespace burin
