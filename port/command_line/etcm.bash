# Completion for the programs of etcm: options and commands as --help tells them, else files.
_etcm() {
  local word=${COMP_WORDS[COMP_CWORD]} command=("$1") each
  local IFS=$' \t\n'
  # A command comes before its options, and may have commands of its own.
  for each in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
    if [[ $each =~ ^[a-z][a-z-]*$ ]] && "${command[@]}" "$each" --help >/dev/null 2>&1 </dev/null; then
      command+=("$each")
    fi
  done
  local help words=""
  help=$("${command[@]}" --help 2>/dev/null </dev/null) || return
  if [[ $word == -* ]]; then
    words=$(grep -oE '(^|[ ,])--?[a-z0-9][a-z0-9-]*' <<<"$help" | tr -d ' ,')
  else
    words=$(sed -n '/^Subcommands:/,/^$/s/^  \([a-z][a-z-]*\) .*/\1/p' <<<"$help")
  fi
  COMPREPLY=($(compgen -W "$words" -- "$word"))
  ((${#COMPREPLY[@]} > 0)) || COMPREPLY=($(compgen -f -- "$word"))
}
complete -o filenames -F _etcm etcm etcm-bus etcm-gateway etcm-nodes
