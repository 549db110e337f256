# fish completion for strut. `strut help --completion fish` prints it; strut itself finds the words.
function __strut_complete
    set -l words (commandline -opc)
    set -l current (commandline -ct)
    for line in ($words[1] complete $words[2..-1] "$current" 2>/dev/null)
        switch $line
            case ':files *'
                for ending in (string split ' ' -- (string replace ':files ' '' -- $line))
                    __fish_complete_suffix $current .$ending
                end
            case ':files'
                __fish_complete_path $current
            case ':folders'
                __fish_complete_directories $current
            case ':'
            case '*'
                printf '%s\n' $line
        end
    end
end
complete -c strut -f -a '(__strut_complete)'
