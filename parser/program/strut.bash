# bash completion for strut, which itself finds the words.
_strut() {
    # bash takes words apart at '=', so they are put together again
    local words=() word line directive=: glued=
    local -i i
    for ((i = 1; i <= COMP_CWORD; i++)); do
        word=${COMP_WORDS[i]}
        if [[ ${#words[@]} -gt 0 && ($word == = || $glued) ]]; then
            words[-1]+=$word
        else
            words+=("$word")
        fi
        glued=
        [[ $word == = ]] && glued=yes
    done
    local current=${words[-1]} cut=
    [[ $COMP_WORDBREAKS == *=* && $current == *=* ]] && cut=${current%"${current##*=}"}
    COMPREPLY=()
    while IFS= read -r line; do
        if [[ $line == :* ]]; then
            directive=$line
        else
            COMPREPLY+=("$(printf %q "${line#"$cut"}")")
        fi
    done < <("${COMP_WORDS[0]}" complete "${words[@]}" 2>/dev/null)
    case $directive in
        ":files "*)
            local ending
            current=${current#"$cut"}
            for ending in ${directive#:files }; do
                mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -f -X "!*.$ending" -- "$current")
            done
            mapfile -t -O ${#COMPREPLY[@]} COMPREPLY < <(compgen -d -- "$current")
            compopt -o filenames 2>/dev/null
            ;;
        :files) compopt -o default 2>/dev/null ;;
        :folders) compopt -o dirnames 2>/dev/null ;;
    esac
}
complete -F _strut strut
