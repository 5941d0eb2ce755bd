# SPDX-License-Identifier: MIT
# tandem_unity(TARGET [EXPRESSION...]): compiles the files of a folder together, which takes a third of the time.
# Files of one unit share one unnamed namespace, where names can clash. Files whose path matches EXPRESSION form a unit
# of their own; the path is relative to the root and without .cpp. Scenes are compiled one by one, because each defines
# make().
function(tandem_unity target)
  set_target_properties(${target} PROPERTIES UNITY_BUILD ON UNITY_BUILD_MODE GROUP)
  get_target_property(sources ${target} SOURCES)
  foreach(source ${sources})
    cmake_path(ABSOLUTE_PATH source OUTPUT_VARIABLE path)
    cmake_path(IS_PREFIX PROJECT_BINARY_DIR ${path} generated)
    cmake_path(RELATIVE_PATH path BASE_DIRECTORY ${PROJECT_SOURCE_DIR})
    if(generated OR NOT path MATCHES "^[a-z_/0-9]+\\.cpp$")
      continue()
    endif()
    cmake_path(GET path PARENT_PATH group)
    if(group STREQUAL "scenes/kinds")
      continue()
    endif()
    foreach(expression ${ARGN})
      if(path MATCHES "^${expression}\\.cpp$")
        set(group ${expression})
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER "${group}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()
