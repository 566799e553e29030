#include "burin/optimize/carving/drawing.h"

#include "burin/render/files/decimals.h"

namespace burin {

std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals) {
  const std::string width = shortest(board_size_mm.x()), height = shortest(board_size_mm.y());
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n";
  text += "<g id=\"scratches\" fill=\"none\" stroke=\"black\" stroke-width=\"0.05\">\n";
  const double h = board_size_mm.y();  // SVG's y runs down
  for (const PlannedScratch& s : path.scratches)
    text += "<line x1=\"" + fixed(s.from_mm.x(), decimals) + "\" y1=\"" + fixed(h - s.from_mm.y(), decimals) +
            "\" x2=\"" + fixed(s.to_mm.x(), decimals) + "\" y2=\"" + fixed(h - s.to_mm.y(), decimals) + "\"/>\n";
  return text + "</g>\n</svg>\n";
}

std::string dxf(const Toolpath& path, int decimals) {
  std::string text;
  const auto group = [&text](int code, const std::string& value) {
    text += std::to_string(code) + "\n" + value + "\n";
  };
  const auto point = [&](int code, const Eigen::Vector2d& p) {
    group(code, fixed(p.x(), decimals));
    group(code + 10, fixed(p.y(), decimals));
    group(code + 20, "0");
  };
  group(0, "SECTION"), group(2, "HEADER");
  group(9, "$ACADVER"), group(1, "AC1009");
  group(9, "$INSUNITS"), group(70, "4");     // millimeters
  group(9, "$MEASUREMENT"), group(70, "1");  // metric
  group(9, "$EXTMIN"), point(10, path.min_mm);
  group(9, "$EXTMAX"), point(10, path.max_mm);
  group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "TABLES");
  group(0, "TABLE"), group(2, "LAYER"), group(70, "1");
  group(0, "LAYER"), group(2, "SCRATCHES"), group(70, "0"), group(62, "7"), group(6, "CONTINUOUS");
  group(0, "ENDTAB"), group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "ENTITIES");
  for (const PlannedScratch& s : path.scratches) {
    group(0, "LINE"), group(8, "SCRATCHES");
    point(10, s.from_mm);
    point(11, s.to_mm);
  }
  group(0, "ENDSEC"), group(0, "EOF");
  return text;
}

}  // namespace burin
