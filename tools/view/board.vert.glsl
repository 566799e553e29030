// The face as a mesh, which bow and lens deform like the scratches.
in vec2 aPlace;                   // 0 to 1 over the board
out vec2 vPlace;                  // mm

void main() {
  vPlace = aPlace * uBoard;
  vec3 q = to_pixel(vec3(vPlace, face_height(vPlace)));
  gl_Position = vec4((2.0 * q.xy / uCanvas - 1.0) * q.z, 0.0, q.z);
}
