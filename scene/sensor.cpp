#include "burin/scene/sensor.h"

namespace burin {

double vignette_radius2(int width, int height, double x_px, double y_px) {
  const double dx = x_px - (width - 1) / 2.0, dy = y_px - (height - 1) / 2.0;
  return (dx * dx + dy * dy) * 4 / (static_cast<double>(width) * width + static_cast<double>(height) * height);
}

float encoded(float linear_value, Encoding encoding) {
  return encoding == Encoding::srgb ? linear_to_srgb(linear_value) : linear_value;
}

}  // namespace burin
