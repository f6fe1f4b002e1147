# Turns the LINK, MOCK, CFLAGS and LDFLAGS comments at the top of C tests into variables for make:
#
#   /* LINK: firmware/input/latch.c */  in tests/unit/test_latch.c  becomes
#   LINK.tests/unit/test_latch := firmware/input/latch.c
#
# A comment may run over several lines and stand there several times.

FNR == 1 {
    inside = 0
    test = FILENAME
    sub(/\.c$/, "", test)
}

match($0, /^\/\* (LINK|MOCK|CFLAGS|LDFLAGS):/) {
    name = substr($0, 4, RLENGTH - 4)
    $0 = substr($0, RLENGTH + 1)
    inside = 1
}

inside {
    last = sub(/\*\/.*/, "")
    sub(/^ \* /, "")
    gsub(/[ \t]+/, " ")
    print name "." test " += " $0
    if (last) {
        inside = 0
    }
}
