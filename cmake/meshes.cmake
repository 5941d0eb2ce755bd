# SPDX-License-Identifier: MIT
# tandem_meshes(TARGET): embeds the meshes of scenes/meshes in the library.
function(tandem_meshes target)
  file(GLOB meshes CONFIGURE_DEPENDS ${PROJECT_SOURCE_DIR}/scenes/meshes/*.node ${PROJECT_SOURCE_DIR}/scenes/meshes/*.ele)
  set(script ${PROJECT_SOURCE_DIR}/cmake/embed_meshes.py)
  set(generated ${PROJECT_BINARY_DIR}/embedded_meshes.cpp)
  add_custom_command(OUTPUT ${generated}
    COMMAND ${Python3_EXECUTABLE} ${script} ${PROJECT_SOURCE_DIR}/scenes/meshes ${generated}
    DEPENDS ${script} ${meshes} COMMENT "Embedding meshes" VERBATIM)
  target_sources(${target} PRIVATE ${generated})
endfunction()
