#include "burin/scene/files/misfit_json.h"

namespace burin {

std::vector<Misfit> read_misfits(JsonObject& bench) {
  std::vector<Misfit> out;
  if (!bench.has("misfits")) return out;
  for (JsonObject& item : bench.objects("misfits")) {
    Misfit m;
    m.test = item.text("test");
    m.sigmas = item.number("sigmas");
    m.alpha_percent = item.number("alpha_percent", 0);
    m.depth_percent = item.number("depth_percent", 0);
    m.base_alpha_percent = item.number("base_alpha_percent", 0);
    for (JsonObject& one : item.objects("classes")) {
      m.classes.push_back({one.text("name"), one.number("residual"), one.number("sigma")});
      one.finish();
    }
    item.text("words", "");
    item.text("remedy", "");
    item.finish();
    out.push_back(std::move(m));
  }
  return out;
}

Json misfits_json(const std::vector<Misfit>& misfits) {
  Json out = Json::array();
  for (const Misfit& m : misfits) {
    Json item{{"test", m.test},
              {"sigmas", m.sigmas},
              {"alpha_percent", m.alpha_percent},
              {"depth_percent", m.depth_percent},
              {"base_alpha_percent", m.base_alpha_percent}};
    item["classes"] = Json::array();
    for (const Misfit::Class& c : m.classes)
      item["classes"].push_back(Json{{"name", c.name}, {"residual", c.residual}, {"sigma", c.sigma}});
    item["words"] = quantity_in_words(m);
    item["remedy"] = remedy_in_words(m);
    out.push_back(std::move(item));
  }
  return out;
}

}  // namespace burin
