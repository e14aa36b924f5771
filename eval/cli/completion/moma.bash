# Completion of moma for bash. Now and here: source <(moma completion bash). Installed, it is
# share/bash-completion/completions/moma, which the package bash-completion reads by itself.
_moma() {
  local line="${COMP_LINE:0:COMP_POINT}" words=() found=() files=0 endings='' candidate rest file
  read -ra words <<<"$line"
  if [[ $line == *[[:space:]] ]]; then words+=(''); fi
  while [[ ${#words[@]} -gt 1 && ${words[0]} == *=* ]]; do words=("${words[@]:1}"); done # NAME=VALUE moma ...
  if ((${#words[@]} < 2)); then return; fi
  local current="${words[-1]}"

  while IFS=$'\t' read -r candidate rest; do
    if [[ $candidate == :files ]]; then
      files=1
      endings=" $rest "
    else
      found+=("$candidate")
    fi
  done < <("${words[0]/#\~/$HOME}" completion words -- "${words[@]:1}" 2>/dev/null)

  if ((files)); then
    compopt -o filenames 2>/dev/null
    if [[ $current == --*=* ]]; then current="${current#*=}"; fi
    while IFS= read -r file; do
      if [[ $endings == '  ' || -d ${file/#\~/$HOME} || $endings == *" ${file##*.} "* ]]; then found+=("$file"); fi
    done < <(compgen -f -- "$current")
  elif [[ ${#found[@]} -eq 1 && ${found[0]} == *[=.] ]]; then
    compopt -o nospace 2>/dev/null
  fi

  # Bash replaces only what stands behind the last of its word breaks.
  local breaks="${COMP_WORDBREAKS//[^=:@]/}" kept=''
  if [[ -n $breaks && $current == *[$breaks]* ]]; then kept="${current%"${current##*[$breaks]}"}"; fi
  COMPREPLY=("${found[@]#"$kept"}")
}
complete -F _moma moma
