#include "burin/scene/misfit.h"

#include <array>
#include <string_view>

namespace burin {
namespace {

struct Words {
  std::string_view test, quantity, remedy;
};

// Quantity of each test, and the usual causes of a misfit.
constexpr std::array<Words, 8> kWords{{
    {"along", "how far half vectors lean along the grooves",
     "the lamp has a size (measure it and write \"disk_mm\" or \"panel_mm\" of the light into bench.json), or the "
     "grooves "
     "have burrs"},
    {"across", "how near half vectors are to the grooves' steepest wall",
     "the groove's cross-section is another (a round tip, straight flanks, burrs: one look through a microscope "
     "tells), "
     "or stray light fills what should be dark"},
    {"azimuth", "which way half vectors lean",
     "the face was brushed, tools push their burr to one side, or a second lamp or a window shines"},
    {"highlight", "how far the lamp's mirror image is",
     "the face is brushed, or not evenly rough, or the lamp has a size (\"disk_mm\" of the light in bench.json)"},
    {"brightness", "how bright pixels are",
     "the camera bends or sharpens its pictures, or its lens scatters light: photograph raw, with every improvement "
     "switched off and a clean lens"},
    {"frame", "where pixels lie in the picture",
     "the lens darkens its corners otherwise than the model, or scatters light: close the aperture by two stops"},
    {"", "a quantity that this version does not know", "see the page of the version that measured it"},
    {"photo ", "whether they are in ",
     "another lamp or a window may shine into it where its mirror image is seen: hang something dark there and "
     "photograph that view again, or leave it out"},
}};

Words words_of(const Misfit& misfit) {
  for (const Words& words : kWords)
    if (words.test == misfit.test) return words;
  if (is_of_photo(misfit)) return kWords.back();
  return kWords[kWords.size() - 2];  // a bench.json of a later version
}

}  // namespace

bool is_of_photo(const Misfit& misfit) { return misfit.test.starts_with(kWords.back().test); }

std::string quantity_in_words(const Misfit& misfit) {
  const Words words = words_of(misfit);
  // The test of one photo contains its name.
  return std::string(words.quantity) + (words.test == kWords.back().test ? misfit.test : "");
}
std::string remedy_in_words(const Misfit& misfit) { return std::string(words_of(misfit).remedy); }

}  // namespace burin
