#include "tools/new/ask.h"

#include <istream>
#include <ostream>

#include "burin/base/error.h"

namespace burin {

void ask(Conversation& talk, const std::string& question, const std::string& usual,
         const std::function<void(const std::string&)>& use) {
  for (;;) {
    talk.out << question << (usual.empty() ? "" : " [" + usual + "]") << ": " << std::flush;
    std::string answer;
    if (!std::getline(talk.in, answer)) {
      talk.out << "\n";
      fail("the answers", "ended before the questions",
           "nothing was written of them; begin again, or give all as options");
    }
    const std::size_t first = answer.find_first_not_of(" \t\r"), last = answer.find_last_not_of(" \t\r");
    answer = first == std::string::npos ? usual : answer.substr(first, last - first + 1);
    try {
      use(answer);
      return;
    } catch (const Error& error) {
      talk.out << "  " << error.what() << "\n";
    }
  }
}

void ask_all(Conversation& talk, const std::vector<Question>& questions) {
  for (std::size_t k = 0; k < questions.size();) {
    bool back = false;
    ask(talk, questions[k].words, questions[k].usual(), [&](const std::string& answer) {
      back = answer == "back";
      if (!back) questions[k].use(answer);
      if (back && k == 0) fail("back", "there is no question before this one", "answer it, or end with Ctrl-D");
    });
    k = back ? k - 1 : k + 1;
  }
}

}  // namespace burin
