// Contribution of one scratch to one pixel: light and covered area (docs/model.md 5.1, 5.2). It is proportional to the exact
// length of the scratch's line inside the pixel's square; wide grooves consist of several parallel lines.
in float vLight;
flat in vec4 vEnds;
flat in vec2 vAcross;
in vec2 vLine;
flat in vec2 vSize;
uniform float uPixelArea;        // approximate, mm^2: unit of the covered area
out vec4 oSum;

// Share of the line inside the unit square around 0.
float inside(vec2 a, vec2 b) {
  vec2 d = b - a;
  d = mix(d, vec2(1e-7), lessThan(abs(d), vec2(1e-7)));
  vec2 t0 = (-0.5 - a) / d, t1 = (0.5 - a) / d;
  vec2 low = min(t0, t1), high = max(t0, t1);
  return max(0.0, min(min(high.x, high.y), 1.0) - max(max(low.x, low.y), 0.0));
}

void main() {
  vec2 a = vEnds.xy - gl_FragCoord.xy, b = vEnds.zw - gl_FragCoord.xy;
  float scale = length(vAcross), light = 0.0, covered = 0.0;
  vec2 middle = vAcross * vLine.x;
  if (vLine.y * scale < 0.08) {
    light = inside(a + middle, b + middle);
  } else {
    vec2 aside = vAcross * vLine.y;
    light = 0.5 * (inside(a + middle - aside, b + middle - aside) + inside(a + middle + aside, b + middle + aside));
  }
  float lines = clamp(ceil(2.5 * vSize.y * scale), 1.0, 12.0);
  for (float i = 0.5; i < lines; i += 1.0) {
    vec2 at = vAcross * (vSize.y * (2.0 * i / lines - 1.0));
    covered += inside(a + at, b + at);
  }
  oSum = vec4(vLight * vSize.x * light, covered / lines * 2.0 * vSize.x * vSize.y / uPixelArea, 0.0, 0.0);
}
