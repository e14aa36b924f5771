#compdef moma
# Completion of moma for zsh. Now and here: source <(moma completion zsh), after compinit. Installed, it is
# share/zsh/site-functions/_moma, which compinit finds where that folder is in $fpath.
_moma() {
  local line candidate rest endings
  local -a closed open
  local -i files=0
  for line in ${(f)"$(${~words[1]} completion words -- "${(@)words[2,CURRENT-1]}" "$PREFIX" 2>/dev/null)"}; do
    candidate=${line%%$'\t'*}
    rest=${line#*$'\t'}
    if [[ $candidate == :files ]]; then
      files=1
      endings=$rest
    elif [[ $candidate == *[=.] ]]; then
      open+=("${candidate//:/\\:}:$rest")
    else
      closed+=("${candidate//:/\\:}:$rest")
    fi
  done
  local -i result=1
  if (( $#closed )); then _describe -t values value closed && result=0; fi
  if (( $#open )); then _describe -t keys key open -S '' && result=0; fi
  if (( files )); then
    if [[ $PREFIX == --*=* ]]; then compset -P '*='; fi
    if [[ -n $endings ]]; then _files -g "*.(${endings// /|})(-.)" && result=0; else _files && result=0; fi
  fi
  return result
}
if [[ ${funcstack[1]} == _moma ]]; then _moma "$@"; else compdef _moma moma; fi
