// tools/new/ask.h - questions to the user at a terminal, one at a time, with the default answer in brackets. An invalid
// answer repeats the question with the reason.
#pragma once

#include <functional>
#include <iosfwd>
#include <string>
#include <vector>

namespace burin {

/// Streams for questions and answers.
struct Conversation {
  std::istream& in;
  std::ostream& out;
};

/// Asks "question [usual]: " until `use` accepts the answer. `use` throws Error for an invalid one, and the message is
/// printed. An empty line stands for `usual`. Throws Error at the end of the input (Ctrl-D).
void ask(Conversation& talk, const std::string& question, const std::string& usual,
         const std::function<void(const std::string&)>& use);

/// One of several questions. `use` may be called again when the user goes back to it.
struct Question {
  std::string words;
  std::function<std::string()> usual;
  std::function<void(const std::string&)> use;
};

/// Asks the questions in order. The answer "back" returns to the previous one.
void ask_all(Conversation& talk, const std::vector<Question>& questions);

}  // namespace burin
