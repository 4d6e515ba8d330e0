/* Ends of a sketch that goes wrong, each with the line of its own that led there. */
#ifndef CRASHES_H
#define CRASHES_H

constexpr int CALLS = 24;
#ifdef __x86_64__
constexpr int COUNTER = REG_RIP;
#else
constexpr int COUNTER = REG_EIP;
#endif

/* End the run. The addresses of the calls that led here come behind the text, the innermost first, from
 * `place` on if one is given: the first that is not the board's own is the sketch's. */
[[noreturn]] void end_at(void *place, const char *text)
{
    void *calls[CALLS];
    int count = backtrace(calls, CALLS), first = 0;
    for (int each = 0; place && each < count; each++)
        if (calls[each] == place)
            first = each + 1;
    char whole[1000];
    int at = snprintf(whole, sizeof whole, "%s [at", text);
    if (place)
        at += snprintf(whole + at, sizeof whole - at, " 0x%llx", (unsigned long long)place);
    for (int each = first; each < count; each++) /* a call returns behind itself */
        at += snprintf(whole + at, sizeof whole - at, " 0x%llx", (unsigned long long)calls[each] - 1);
    snprintf(whole + at, sizeof whole - at, "]");
    link_answer(now, whole);
    _exit(0);
}

void crashed(int number, siginfo_t *info, void *context)
{
    char *at = (char *)info->si_addr;
    if (number == SIGSEGV && at >= stack - GUARD && at < stack)
        end("it overran its stack of %zu kB: a recursion without end, or large local arrays "
            "(the board has %s in all)",
            stack_size >> 10, board::MEMORY);
    if (at == nullptr && ((ucontext_t *)context)->uc_mcontext.gregs[COUNTER] == 0)
        reset(); /* a jump to the beginning of the program */
    greg_t place = ((ucontext_t *)context)->uc_mcontext.gregs[COUNTER];
    char text[160];
    int length = snprintf(text, sizeof text, "it crashed: %s", strsignal(number));
    if (number == SIGSEGV)
        snprintf(text + length, sizeof text - length, " at address 0x%llx", (unsigned long long)at);
    end_at((void *)place, text);
}

/* Ten times in a second of CPU time: a loop without any code in it is not instrumented. Often it waits
 * for the watchdog. */
void watch_for_hang(int)
{
    static uint64_t before = NEVER;
    if (now == before && watchdog_due != NEVER)
        pass_until(watchdog_due);
    if (now == before)
        end("it does not go on and calls nothing: an endless loop");
    before = now;
}

void catch_crashes()
{
    void *once;
    backtrace(&once, 1); /* loads what it needs, which a handler must not */
    static char alternative[64 << 10];
    stack_t other = {alternative, 0, sizeof alternative};
    sigaltstack(&other, nullptr);
    struct sigaction action = {};
    action.sa_sigaction = crashed;
    action.sa_flags = SA_SIGINFO | SA_ONSTACK | SA_NODEFER;
    for (int number : {SIGSEGV, SIGBUS, SIGFPE, SIGILL, SIGABRT})
        sigaction(number, &action, nullptr);
    struct sigaction ticking = {};
    ticking.sa_handler = watch_for_hang;
    ticking.sa_flags = SA_RESTART | SA_ONSTACK;
    sigaction(SIGVTALRM, &ticking, nullptr);
    itimerval often = {{0, 100000}, {0, 100000}};
    setitimer(ITIMER_VIRTUAL, &often, nullptr);
}

#endif
