# SPDX-License-Identifier: MIT
# tandem_unity(TARGET [EXPRESSION...]): compiles files together, because headers and templates of each unit cost about as
# much as its code. Files whose path matches EXPRESSION form a unit, the last one that matches; the
# path is relative to the root and without .cpp. Other files form a unit per folder.
# Files of one unit share one unnamed namespace. Where names clash, rename one, or give its file an EXPRESSION.
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
    foreach(expression ${ARGN})
      if(path MATCHES "^${expression}\\.cpp$")
        set(group ${expression})
      endif()
    endforeach()
    string(MAKE_C_IDENTIFIER "${group}" group)
    set_source_files_properties(${source} PROPERTIES UNITY_GROUP ${group})
  endforeach()
endfunction()
