// Radiance of one pixel from its scratches' sums, the plain face and the surroundings (docs/model.md 5.1 to 5.4), encoded for
// a screen.
in vec2 vPlace;
uniform sampler2D uSums;
uniform float uPixelArea, uLightUnit;
uniform float uBaseAlpha;
uniform vec3 uF0, uIntensity, uAmbient;
uniform float uExposure;
uniform int uStored;              // 0: encoded for a screen; 1: radiance * exposure, for measurements and sums; 2: its square root
uniform sampler2D uBefore;        // sum of the lights before
uniform int uHasBefore;           // 0: no light before; else as uStored
out vec4 oColor;

const float kPi = 3.14159265358979;

vec3 to_srgb(vec3 v) {
  return mix(1.055 * pow(max(v, vec3(1e-9)), vec3(1.0 / 2.4)) - 0.055, 12.92 * v, lessThanEqual(v, vec3(0.0031308)));
}

void main() {
  // As in `burin render`, a pixel with a footprint partly outside of the face is empty.
  vec2 dx = dFdx(vPlace), dy = dFdy(vPlace), reach = 0.5 * (abs(dx) + abs(dy));
  if (any(lessThan(vPlace, reach)) || any(greaterThan(vPlace + reach, uBoard))) discard;
  float area = max(abs(dx.x * dy.y - dx.y * dy.x), 1e-12);
  vec2 sums = texelFetch(uSums, ivec2(gl_FragCoord.xy), 0).xy * (uPixelArea / area) * vec2(uLightUnit, 1.0);
  vec3 p = vec3(vPlace, face_height(vPlace)), n = face_normal(vPlace);
  vec3 to_lamp = uLamp - p, wi = normalize(to_lamp), wo = normalize(uEye - p), h = normalize(wi + wo);
  float cos_i = dot(n, wi), cos_o = dot(n, wo), cos_ho = dot(h, wo);
  vec3 radiance = vec3(0.0);
  if (cos_o > 0.0) {
    radiance = uAmbient * uF0;
    float facing = dot(uAxis, -wi), spot = uExponent > 0.0 ? pow(max(facing, 0.0), uExponent) : 1.0;
    if (cos_i > 0.0) {
      float nh = dot(n, h), a2 = uBaseAlpha * uBaseAlpha, b = nh * nh * (a2 - 1.0) + 1.0;
      float base = nh > 0.0 ? a2 / (kPi * b * b) * smith_G1(cos_i, uBaseAlpha) * smith_G1(cos_o, uBaseAlpha) : 0.0;
      vec3 F = uF0 + (1.0 - uF0) * pow(1.0 - cos_ho, 5.0);
      radiance += F * uIntensity * (spot / (4.0 * cos_o * dot(to_lamp, to_lamp)) *
                                    (sums.x + (1.0 - min(1.0, sums.y)) * base));
    }
  }
  radiance *= uExposure;
  if (uHasBefore != 0) {
    vec3 before = texelFetch(uBefore, ivec2(gl_FragCoord.xy), 0).rgb;
    radiance += uHasBefore == 2 ? before * before : before;
  }
  vec3 whole = clamp(radiance, 0.0, 1.0);
  oColor = vec4(uStored == 1 ? radiance : uStored == 2 ? sqrt(whole) : to_srgb(whole), 1.0);
}
