# SPDX-License-Identifier: MIT
# Completion of tandem for bash. The program lists possible words. If it has none, file names are completed.
# shellcheck shell=bash
_tandem() {
  # Bash also splits words at '=' and ':'. This loop joins them again: words are separated only by blanks in the line.
  local line=${COMP_LINE-"${COMP_WORDS[*]:0:COMP_CWORD+1}"} words=() behind word i
  line=${line:0:${COMP_POINT:-${#line}}}
  for ((i = 0; i <= COMP_CWORD; i++)); do
    behind=${line#"${line%%[![:blank:]]*}"}
    word=${COMP_WORDS[i]}
    if ((i == COMP_CWORD)); then word=$behind; fi
    if ((i > 1)) && [[ $behind == "$line" ]]; then
      words[-1]+=$word
    elif ((i > 0)); then
      words+=("$word")
    fi
    line=${behind#"$word"}
  done
  mapfile -t COMPREPLY < <("${COMP_WORDS[0]}" completion --words "${words[@]}" 2>/dev/null)
  # Bash replaces only the last part of a split word, so that the parts before it are removed from the replies.
  local breaks=${COMP_WORDBREAKS//[^=:]/} current=${words[-1]}
  if [[ -n $breaks && $current == *[$breaks]* ]]; then
    local before=${current%"${current##*["$breaks"]}"}
    COMPREPLY=("${COMPREPLY[@]#"$before"}")
  fi
  if [[ ${#COMPREPLY[@]} == 1 && ${COMPREPLY[0]} == *= ]]; then compopt -o nospace 2>/dev/null; fi
  return 0
}
complete -o bashdefault -o default -F _tandem tandem
