#include "burin/capture/tags/tag_fault.h"

#include "burin/base/files/decimals.h"

namespace burin {

std::string in_words(const RejectedTag& tag) {
  switch (tag.fault) {
    case TagFault::unlisted:
      return "it is not in board.json's list";
    case TagFault::unreadable:
      return "it can hardly be read (low contrast or blurred)";
    case TagFault::repeated:
      return "its id is seen " + fixed(tag.measured, 0) +
             " times in the photo: a reflection or a second copy; cover it";
    case TagFault::at_edge:
      return "it touches the edge of the photo";
    case TagFault::small:
      return "it is too small in the photo: go closer or print it larger";
    case TagFault::clipped:
      return "its white paper is clipped: add a shorter exposure";
    case TagFault::covered:
      return "one of its sides is covered, glares or is out of focus";
    case TagFault::no_corners:
      return "its sides do not meet in corners";
    case TagFault::shifted:
      return "its corners do not lie where its sides meet: covered or damaged";
    case TagFault::photo_blurred:
      return "the photo is blurred, its edges " + fixed(tag.measured, 1) + " px wide, the others' " +
             fixed(tag.usual, 1) + " px: out of focus, moved while it was exposed, or exposed twice";
  }
  return {};
}

}  // namespace burin
