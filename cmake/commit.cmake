# SPDX-License-Identifier: MIT
# Writes commit.h when the commit or the state of the tree changed. COMMIT overrides, for trees without git.
if(COMMIT STREQUAL "")
  execute_process(COMMAND git rev-parse --short=12 HEAD WORKING_DIRECTORY ${SOURCE} OUTPUT_VARIABLE COMMIT
                  OUTPUT_STRIP_TRAILING_WHITESPACE ERROR_QUIET)
  execute_process(COMMAND git status --porcelain --untracked-files=no WORKING_DIRECTORY ${SOURCE}
                  OUTPUT_VARIABLE changes ERROR_QUIET)
endif()
string(REGEX REPLACE "-dirty$" "" clean "${COMMIT}")
if("${changes}" STREQUAL "" AND clean STREQUAL COMMIT)
  set(dirty false)
else()
  set(dirty true)
endif()
file(CONFIGURE OUTPUT ${OUT} CONTENT "#define TANDEM_COMMIT_ID \"${clean}\"\n#define TANDEM_COMMIT_DIRTY ${dirty}\n")
