#compdef strut
# zsh completion for strut. `strut help --completion zsh` prints it; strut itself finds the words.
_strut() {
    local line directive=: word
    local -a found unfinished arguments
    arguments=("${(@Q)words[2,CURRENT]}")
    for line in "${(@f)$("${(Q)words[1]}" complete "${arguments[@]}" 2>/dev/null)}"; do
        if [[ $line == :* ]]; then
            directive=$line
            continue
        fi
        word=${${line%%$'\t'*}//:/\\:}
        [[ $line == *$'\t'* ]] && word+=:${line#*$'\t'}
        if [[ ${line%%$'\t'*} == *= ]]; then
            unfinished+=("$word")
        else
            found+=("$word")
        fi
    done
    (( $#found )) && _describe -V strut found
    (( $#unfinished )) && _describe -V strut unfinished -S ''
    case $directive in
        ':files '*) _files -g "*.(${${directive#:files }// /|})(-.)" ;;
        :files) _files ;;
        :folders) _files -/ ;;
    esac
}
if [[ $funcstack[1] == _strut ]]; then
    _strut "$@"
else
    compdef _strut strut
fi
