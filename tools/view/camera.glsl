// Projects a point of the board, through a camera with its lens, or flat (docs/model.md 1). Returns pixels of the canvas in
// WebGL's convention (the lower-left corner of the lower-left pixel is (0, 0)), and the depth.
uniform int uFlat;
uniform vec4 uFlatMap;            // flat: pixel = xy + zw * board mm
uniform mat3 uR;                  // camera: T_camera_board
uniform vec3 uT;
uniform vec4 uLens;               // fx, fy, cx, cy, in the canvas' own pixels: y downwards, (0, 0) is the first pixel's center
uniform vec4 uK0, uK1, uK2;       // OpenCV's k1 k2 p1 p2, k3 k4 k5 k6, s1 s2 s3 s4
uniform vec2 uCanvas;             // size, pixels
uniform vec2 uBoard;              // size, mm
uniform vec3 uBow;                // mm: docs/model.md 1.2

float face_height(vec2 p) {
  vec2 q = 2.0 * p / uBoard - 1.0;
  return uBow.x * q.x * q.x + uBow.y * q.x * q.y + uBow.z * q.y * q.y;
}

vec3 face_normal(vec2 p) {
  vec2 q = 2.0 * p / uBoard - 1.0;
  vec2 slope = vec2(2.0 * uBow.x * q.x + uBow.y * q.y, uBow.y * q.x + 2.0 * uBow.z * q.y) * 2.0 / uBoard;
  return normalize(vec3(-slope, 1.0));
}

vec3 to_pixel(vec3 p) {
  if (uFlat == 1) return vec3(uFlatMap.xy + uFlatMap.zw * p.xy, 1.0);
  vec3 c = uR * p + uT;
  float z = max(c.z, 1e-3);
  vec2 s = c.xy / z;
  float r2 = dot(s, s), r4 = r2 * r2, r6 = r4 * r2;
  float radial = (1.0 + uK0.x * r2 + uK0.y * r4 + uK1.x * r6) / (1.0 + uK1.y * r2 + uK1.z * r4 + uK1.w * r6);
  vec2 d = s * radial + vec2(2.0 * uK0.z * s.x * s.y + uK0.w * (r2 + 2.0 * s.x * s.x),
                             uK0.z * (r2 + 2.0 * s.y * s.y) + 2.0 * uK0.w * s.x * s.y) +
           vec2(uK2.x * r2 + uK2.y * r4, uK2.z * r2 + uK2.w * r4);
  vec2 q = uLens.xy * d + uLens.zw;
  return vec3(q.x + 0.5, uCanvas.y - q.y - 0.5, c.z);
}
