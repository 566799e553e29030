// Eye, lamp and what lies between. docs/model.md 3 and 5.
uniform vec3 uEye, uLamp;         // mm
uniform vec3 uAxis;               // where a spot points
uniform float uExponent;          // its fall-off; 0: a bare lamp

float smith_G1(float c, float alpha) {   // 3.2
  if (c <= 0.0) return 0.0;
  return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)));
}

// The rotation that takes a normal to z by the shortest way (1.1), applied to v.
vec3 to_face(vec3 v, vec3 n) {
  vec3 m = n + vec3(0.0, 0.0, 1.0);
  return v - m * (dot(m, v) / (1.0 + n.z)) + vec3(0.0, 0.0, 2.0 * dot(n, v));
}
