#include "burin/optimize/toolpath/drawing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "burin/base/files/decimals.h"

namespace burin {
namespace {

// A layer's color for SVG, and its number for DXF; colors repeat after the last one.
struct LayerColor {
  const char* svg;
  int dxf;
};
constexpr std::array<LayerColor, 7> kLayerColors{
    {{"#000000", 7}, {"#ff0000", 1}, {"#0000ff", 5}, {"#00a000", 3}, {"#ff00ff", 6}, {"#00a0a0", 4}, {"#a0a000", 2}}};

const LayerColor& color_of(std::size_t layer) { return kLayerColors[layer % kLayerColors.size()]; }

// R12's names hold capitals, digits, $ - and _.
std::string depth_name(double depth_um, int decimals) {
  std::string name = "DEPTH_" + fixed(depth_um, decimals) + "_UM";
  std::replace(name.begin(), name.end(), '.', '_');
  return name;
}

}  // namespace

DrawingLayers drawing_layers(const Toolpath& path) {
  constexpr std::size_t kMostLayers = 60;
  for (double step_um = 0.1;; step_um *= 10) {
    std::map<long long, std::size_t> depths;  // in steps
    const auto steps = [&](const PlannedScratch& s) { return std::llround(1e3 * s.depth_mm / step_um); };
    for (const PlannedScratch& s : path.scratches) depths[steps(s)] = 0;
    if (depths.size() > kMostLayers) continue;
    DrawingLayers out;
    for (auto& [depth, layer] : depths) {
      layer = out.names.size();
      out.names.push_back(depths.size() == 1 ? std::string("SCRATCHES")
                                             : depth_name(static_cast<double>(depth) * step_um, step_um < 1 ? 1 : 0));
    }
    for (const PlannedScratch& s : path.scratches) out.layer.push_back(depths[steps(s)]);
    return out;
  }
}

std::string svg(const Toolpath& path, const Eigen::Vector2d& board_size_mm, int decimals) {
  const std::string width = shortest(board_size_mm.x()), height = shortest(board_size_mm.y());
  std::string text =
      "<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<svg xmlns=\"http://www.w3.org/2000/svg\" "
      "xmlns:inkscape=\"http://www.inkscape.org/namespaces/inkscape\" version=\"1.1\" width=\"" +
      width + "mm\" height=\"" + height + "mm\" viewBox=\"0 0 " + width + " " + height + "\">\n";
  const double h = board_size_mm.y();  // SVG's y points down
  const DrawingLayers layers = drawing_layers(path);
  const auto place = [&](const Eigen::Vector2d& p) {
    return fixed(p.x(), decimals) + " " + fixed(h - p.y(), decimals);
  };
  for (std::size_t layer = 0; layer < layers.names.size(); ++layer) {
    const std::string& name = layers.names[layer];
    text += "<g id=\"" + name + "\" inkscape:groupmode=\"layer\" inkscape:label=\"" + name +
            "\" fill=\"none\" stroke=\"" + color_of(layer).svg + "\" stroke-width=\"0.05\">\n";
    for (std::size_t i = 0; i < path.scratches.size(); ++i)
      if (layers.layer[i] == layer)
        text += "<path d=\"M " + place(path.scratches[i].from_mm) + " L " + place(path.scratches[i].to_mm) + "\"/>\n";
    text += "</g>\n";
  }
  return text + "</svg>\n";
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
  const DrawingLayers layers = drawing_layers(path);
  group(0, "SECTION"), group(2, "HEADER");
  group(9, "$ACADVER"), group(1, "AC1009");
  group(9, "$INSUNITS"), group(70, "4");     // millimeters
  group(9, "$MEASUREMENT"), group(70, "1");  // metric
  group(9, "$EXTMIN"), point(10, path.min_mm);
  group(9, "$EXTMAX"), point(10, path.max_mm);
  group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "TABLES");
  group(0, "TABLE"), group(2, "LTYPE"), group(70, "1");
  group(0, "LTYPE"), group(2, "CONTINUOUS"), group(70, "0"), group(3, "Solid line"), group(72, "65");
  group(73, "0"), group(40, "0");
  group(0, "ENDTAB");
  group(0, "TABLE"), group(2, "LAYER"), group(70, std::to_string(layers.names.size() + 1));
  group(0, "LAYER"), group(2, "0"), group(70, "0"), group(62, "7"), group(6, "CONTINUOUS");
  for (std::size_t layer = 0; layer < layers.names.size(); ++layer) {
    group(0, "LAYER"), group(2, layers.names[layer]), group(70, "0");
    group(62, std::to_string(color_of(layer).dxf)), group(6, "CONTINUOUS");
  }
  group(0, "ENDTAB"), group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "BLOCKS"), group(0, "ENDSEC");
  group(0, "SECTION"), group(2, "ENTITIES");
  for (std::size_t i = 0; i < path.scratches.size(); ++i) {
    group(0, "LINE"), group(8, layers.names[layers.layer[i]]);
    point(10, path.scratches[i].from_mm);
    point(11, path.scratches[i].to_mm);
  }
  group(0, "ENDSEC"), group(0, "EOF");
  return text;
}

}  // namespace burin
