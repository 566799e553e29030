// A scratch as a strip of pixels: its two ends on the screen, and the light from each end to the eye, per mm. The light follows
// from the closed form of docs/model.md 4 over the groove's whole width. The shader reads four vertices per scratch from a
// table by their index, because instances of four vertices each are slow on many machines.
uniform highp usampler2D uRows;   // x and y of the center, direction, length
uniform highp usampler2D uOwn;    // width, depth, alpha of rows with values of their own
uniform int uHasOwn;
uniform vec4 uArea;               // range of the centers, mm: minimum, and maximum - minimum
uniform float uLongest;           // mm
uniform vec2 uWidth, uDepth, uAlpha;  // ranges of wt and d in mm, and of alpha: minimum, and maximum - minimum
uniform float uPixelArea, uLightUnit; // approximate area of a pixel, mm^2, and the Dhat G in it that counts as 1
out float vLight;                 // Dhat G per mm of length
flat out vec4 vEnds;              // on the screen
flat out vec2 vAcross;            // 1 mm across the groove, on the screen
out vec2 vLine;                   // origin of the light across the groove, mm: mean and standard deviation
flat out vec2 vSize;              // length and half width w, mm

const float kPi = 3.14159265358979;

// W's integral over the groove (4.2), and the glint's place in t: mean and standard deviation.
vec3 glint(vec3 h, float alpha, float rim) {
  float r = sqrt(max(0.0, (1.0 - alpha) * (1.0 + alpha)));
  float H2 = h.x * h.x + h.z * h.z, H = sqrt(H2);
  float lo = -rim, hi = rim;                                                          // 4.4
  float cut = h.z / max(abs(h.x) + H, 1e-20);
  if (h.x >= 0.0) hi = min(hi, cut); else lo = max(lo, -cut);
  if (!(hi > lo)) return vec3(0.0);
  float e = r * h.x, k = r * h.z, s2 = max(h.y * h.y + alpha * alpha * H2, 1e-12), s = sqrt(s2);
  float p = 1.0 + k, q = (e * e + s2) / p;                                            // 4.5
  float t1 = p * lo + e, t2 = p * hi + e, N1 = t1 * t1 + s2, N2 = t2 * t2 + s2;
  float J1 = (atan(t2 / s) - atan(t1 / s)) / s;                                       // 4.9
  float J2 = 0.5 * ((t2 / N2 - t1 / N1) + J1) / s2;
  float K1 = 0.5 * log(N2 / N1), K2 = 0.5 * (1.0 / N1 - 1.0 / N2);
  float g = 2.0 * (1.0 - s2 / p), f = 2.0 * e / p, c = 2.0 / p + 1.0;                 // 4.8
  float front = ((1.0 / (p * p) + 1.0 / p) * (t2 - t1) + (c * g + f * f) * J1 - c * f * K1 +
                 (g * g - f * f * s2) * J2 - 2.0 * g * f * K2) / p;
  float back = 0.0;                                                                   // smooth: three nodes suffice
  for (int i = -1; i <= 1; ++i) {
    float t = 0.5 * (lo + hi) + 0.5 * (hi - lo) * 0.7745966692 * float(i);
    float R = (1.0 + t * t) / (p - 2.0 * e * t + q * t * t);
    back += (i == 0 ? 8.0 : 5.0) / 18.0 * (hi - lo) * (R * R + R);
  }
  // Across the groove, the light is distributed like 1 / N^2, in x = tau / s.
  float x1 = t1 / s, x2 = t2 / s;
  float m0 = 0.5 * (x2 / (1.0 + x2 * x2) - x1 / (1.0 + x1 * x1) + atan(x2) - atan(x1));
  float m2 = 0.5 * (atan(x2) - atan(x1) - x2 / (1.0 + x2 * x2) + x1 / (1.0 + x1 * x1));
  float mean = clamp(0.0, x1, x2), deviation = 0.0;
  if (m0 > 1e-4) {
    mean = clamp(0.5 * (1.0 / (1.0 + x1 * x1) - 1.0 / (1.0 + x2 * x2)) / m0, x1, x2);
    deviation = sqrt(max(0.0, m2 / m0 - mean * mean));
  }
  return vec3(max(0.0, 0.25 * (front + back)), (s * mean - e) / p, s * deviation / p);
}

void main() {
  int scratch = gl_VertexID >> 2, corner = gl_VertexID & 3;
  ivec2 at_row = ivec2(scratch & 1023, scratch >> 10);
  vec4 row = vec4(texelFetch(uRows, at_row, 0));
  vec3 own = uHasOwn == 1 ? vec3(texelFetch(uOwn, at_row, 0).xyz) / 65535.0 : vec3(0.0);
  float turn = row.z / 65536.0 * kPi, size = row.w / 65535.0 * uLongest;
  vec2 middle = uArea.xy + uArea.zw * row.xy / 65535.0, along = vec2(cos(turn), sin(turn)), across = vec2(along.y, -along.x);
  float width = uWidth.x + uWidth.y * own.x, depth = uDepth.x + uDepth.y * own.y, alpha = uAlpha.x + uAlpha.y * own.z;
  float u = 2.0 * depth / width;
  float rim = sqrt(u < 0.01 ? u * (1.0 - 0.5 * u) : 1.0 - exp(-u));                   // 2.2
  float which = corner < 2 ? -0.5 : 0.5, side = (corner & 1) == 0 ? -1.0 : 1.0;
  vec2 here = middle + which * size * along;

  vec3 p = vec3(here, face_height(here)), n = face_normal(here);
  vec3 wi = normalize(uLamp - p), wo = normalize(uEye - p), h = to_face(normalize(wi + wo), n);
  float G = smith_G1(dot(n, wi), alpha) * smith_G1(dot(n, wo), alpha);
  vec3 w = vec3(0.0);
  if (G > 0.0) w = glint(vec3(dot(across, h.xy), dot(along, h.xy), h.z), alpha, rim);
  vLight = 0.5 * width * alpha * alpha / kPi * w.x * G / (uPixelArea * uLightUnit);
  vLine = 0.5 * width * w.yz;

  vec2 a = middle - 0.5 * size * along, b = middle + 0.5 * size * along;
  vec3 A = to_pixel(vec3(a, face_height(a))), B = to_pixel(vec3(b, face_height(b)));
  float step = max(0.5 * width, 0.01);
  vec2 c = middle + step * across;
  vAcross = (to_pixel(vec3(c, face_height(c))).xy - 0.5 * (A.xy + B.xy)) / step;
  vEnds = vec4(A.xy, B.xy);
  vSize = vec2(size, 0.5 * width * rim);
  // Covers all pixels in reach: half a pixel's diagonal around the groove.
  vec2 d = B.xy - A.xy;
  float length_px = length(d);
  vec2 y = length_px > 1e-6 ? d / length_px : vec2(1.0, 0.0), x = vec2(y.y, -y.x);
  float wide = 0.75 + vSize.y * abs(dot(vAcross, x)), longer = 0.75 + vSize.y * abs(dot(vAcross, y));
  vec2 at = (corner < 2 ? A.xy : B.xy) + x * (side * wide) + y * (sign(which) * longer);
  gl_Position = vec4(2.0 * at / uCanvas - 1.0, 0.0, 1.0);
  if (A.z <= 1e-3 || B.z <= 1e-3) gl_Position = vec4(2.0, 2.0, 2.0, 1.0);             // behind the eye
}
