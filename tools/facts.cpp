#include "tools/facts.h"

namespace burin {

void Facts::set(const std::string& name, Json value, const std::string& unit, Json sigma) {
  Json& into = report_->data[at_ / name];
  if (unit.empty() && sigma.is_null()) {
    into = std::move(value);
    return;
  }
  into = {{"value", std::move(value)}};
  if (!unit.empty()) into["unit"] = unit;
  if (!sigma.is_null()) into["sigma"] = std::move(sigma);
}

Facts Facts::in(const std::string& name) const {
  Json& object = report_->data[at_ / name];
  if (object.is_null()) object = Json::object();
  return {*report_, at_ / name};
}

Facts Facts::add(const std::string& name) const {
  Json& list = report_->data[at_ / name];
  list.push_back(Json::object());
  return {*report_, at_ / name / (list.size() - 1)};
}

void Facts::add_text(const std::string& text) { report_->text += text; }

}  // namespace burin
