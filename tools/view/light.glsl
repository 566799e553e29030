// Eye, lamp, and the light between them (docs/model.md 3 and 5).
uniform vec3 uEye, uLamp;         // mm
uniform vec3 uAxis;               // direction of a spotlight
uniform float uExponent;          // fall-off of the spotlight; 0: a bare lamp

float smith_G1(float c, float alpha) {   // 3.2
  if (c <= 0.0) return 0.0;
  return 2.0 / (1.0 + sqrt(1.0 + alpha * alpha * (1.0 - c * c) / (c * c)));
}

// Rotates v by the shortest rotation from the normal to z (1.1).
vec3 to_face(vec3 v, vec3 n) {
  vec3 m = n + vec3(0.0, 0.0, 1.0);
  return v - m * (dot(m, v) / (1.0 + n.z)) + vec3(0.0, 0.0, 2.0 * dot(n, v));
}
