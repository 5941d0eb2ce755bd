# SPDX-License-Identifier: MIT
# Writes commit.h when the commit, the state of the tree or the sources change. COMMIT overrides the commit of git, for
# trees without git. `tandem --version` prints VERSION and PARTS.
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
# Digest of the files that determine times, answers and stored references, in the order of their paths. It is equal on every machine and
# needs no git.
set(sources)
file(GLOB_RECURSE files RELATIVE ${SOURCE} ${SOURCE}/base/*.cpp ${SOURCE}/base/*.h ${SOURCE}/geometry/*.cpp ${SOURCE}/geometry/*.h ${SOURCE}/backends/*.cpp ${SOURCE}/backends/*.h ${SOURCE}/algorithms/*.c* ${SOURCE}/algorithms/*.h
     ${SOURCE}/scenes/*.cpp ${SOURCE}/scenes/*.h ${SOURCE}/harness/sampling/* ${SOURCE}/harness/verify/* ${SOURCE}/cmake/embed_kernels.py ${SOURCE}/cmake/kernel_arguments.py)
foreach(file ${files})
  file(SHA256 ${SOURCE}/${file} digest)
  string(APPEND sources "${file} ${digest}\n")
endforeach()
string(SHA256 sources "${sources}")
string(SUBSTRING ${sources} 0 16 sources)
file(CONFIGURE OUTPUT ${OUT} CONTENT "#define TANDEM_COMMIT_ID \"${clean}\"\n#define TANDEM_COMMIT_DIRTY ${dirty}\n#define TANDEM_SOURCES \"${sources}\"\n\
#define TANDEM_VERSION \"${VERSION}\"\n#define TANDEM_PARTS \"${PARTS}\"\n")
