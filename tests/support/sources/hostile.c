/* A unit that does one thing that no unit should, for FMI 1.0, 2.0 and 3.0 Co-Simulation: -DFMI=1, 2 or 3.

   y' = gain u - y by explicit Euler, n counts the steps, b = true, s = "text". What it does wrong is the word
   behind "hostile:" in the GUID (FMI 3.0: instantiation token) that it is instantiated with; see `act` below
   and support/hostile/units.py. What happens in a step happens in those that begin at t = 0.05 s or later.
   -DLOADING=1 crashes, 2 exits, 3 hangs in the library's constructor. */

#define _GNU_SOURCE
#include <dlfcn.h>
#include <fenv.h>
#include <locale.h>
#include <math.h>
#include <pthread.h>
#include <signal.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/time.h>
#include <unistd.h>

#define EXPORT __attribute__((visibility("default")))
enum { OK, WARNING, DISCARD, ERROR, FATAL, PENDING };
enum { U, Y, GAIN, N, B, S };

typedef unsigned int Reference;
#if FMI == 3
typedef void (*Logger)(void *, int, const char *, const char *);
typedef bool Bool;
#else
typedef void (*Logger)(void *, const char *, int, const char *, const char *, ...);
typedef int Bool;
#endif

typedef struct {
    double u, y, gain, time;
    int n;
    void *environment;
    Logger log;
} Unit;

static char act_[64] = "";
static int *volatile nowhere; /* where the compiler cannot see that it is */

static int act(const char *word) { return !strcmp(act_, word); }

static void hang(void) { for (volatile int i = 0;; i++) {} }

static int deeper(volatile int n) { return n ? deeper(n + 1) + n : 0; }

static void for_descriptors(void (*what)(int)) { for (int i = 0; i < 64; i++) what(i); }

static void closed(int i) { close(i); }

static void truncated(int i) { if (ftruncate(i, 0)) {} }

/* A frame of so many bytes as the units' processes send them, on whatever is a socket. */
static const char *said;
static size_t length;

static void answered(int i) {
    struct stat about;
    if (fstat(i, &about) || !S_ISSOCK(about.st_mode)) return;
    uint32_t n = (uint32_t)length;
    if (write(i, &n, sizeof n) < 0 || write(i, said, length) < 0) {}
}

static void answer(const char *text, size_t n) { said = text, length = n, for_descriptors(answered); }

static void tell(Unit *u, int status, const char *text) {
    if (!u->log) return;
#if FMI == 3
    u->log(u->environment, status, "logStatus", text);
#else
    u->log(FMI == 1 ? (void *)u : u->environment, "bad", status, "logStatus", text);
#endif
}

static void *tell_from_a_thread(void *u) {
    for (int i = 0; i < 100; i++) tell(u, WARNING, "from another thread");
    return NULL;
}

static void write_own_library(void) {
    Dl_info about;
    if (!dladdr((void *)write_own_library, &about) || unlink(about.dli_fname)) abort();
    FILE *file = fopen(about.dli_fname, "w");
    fputs("no library", file);
    fclose(file);
}

static void fork_sleeper(bool of_its_own_session) {
    if (fork()) return;
    if (of_its_own_session) setsid();
    sleep(60);
    _exit(0);
}

static void end(void) {
    if (act("segfault")) *nowhere = 1;
    if (act("abort")) abort();
    if (act("double_free")) { char *volatile p = malloc(100); free(p); free(p); }
    if (act("exit0")) exit(0);
    if (act("_exit3")) _exit(3);
    if (act("pthread_exit")) pthread_exit(NULL);
    if (act("exec")) execl("/bin/true", "true", (char *)NULL);
    if (act("kill_itself")) kill(getpid(), SIGKILL);
    if (act("stop_itself")) kill(getpid(), SIGSTOP);
    if (act("divide")) { volatile int one = 1, zero = 0; one = one / zero; }
    if (act("illegal")) __builtin_trap();
    if (act("recursion")) deeper(1);
    if (act("hang")) hang();
    if (act("hang_ignoring_signals")) { for (int i = 1; i < 32; i++) signal(i, SIG_IGN); hang(); }
    if (act("sleep")) for (;;) sleep(60);
    if (act("memory")) for (;;) { char *p = malloc(1 << 28); if (!p) abort(); p[0] = 1; }
    if (act("file")) { FILE *f = fopen("large", "w"); static char block[1 << 20]; for (;;) fwrite(block, 1, sizeof block, f); }
    if (act("alarm")) { struct itimerval soon = {{0, 0}, {0, 1000}}; setitimer(ITIMER_REAL, &soon, NULL); hang(); }
    if (act("fork_and_exit")) { fork_sleeper(false); _exit(3); }
    if (act("close_all")) { for_descriptors(closed); usleep(1000000); }
    if (act("truncate_all")) { for_descriptors(truncated); answer("+", 1); hang(); }
    if (act("answer_nonsense")) { answer("nonsense", 8); hang(); }
    if (act("answer_nesting")) { static char deep[500000]; memset(deep, '[', sizeof deep); answer(deep, sizeof deep); hang(); }
    if (act("answer_endless")) { static char x[1 << 20]; for (;;) answer(x, sizeof x); }
    if (act("null_callback")) ((void (*)(void *, int))(void *)nowhere)(NULL, 0);
}

static void disturb(Unit *u) {
    if (act("fork")) for (int i = 0; i < 5; i++) fork_sleeper(false);
    if (act("daemon") && u->n == 5) fork_sleeper(true);
    if (act("signals")) for (int i = 1; i < 32; i++) signal(i, SIG_IGN);
    if (act("chdir") && chdir("/")) {}
    if (act("environment")) clearenv();
    if (act("locale")) setlocale(LC_ALL, "");
    if (act("no_files")) { struct rlimit none = {0, 0}; setrlimit(RLIMIT_NOFILE, &none); }
    if (act("rounding")) fesetround(FE_UPWARD);
#ifdef __SSE__
    if (act("flush_to_zero")) __builtin_ia32_ldmxcsr(__builtin_ia32_stmxcsr() | 0x8040);
#endif
    if (act("traps") || act("trapped_nan")) feenableexcept(FE_INVALID | FE_DIVBYZERO | FE_OVERFLOW);
    if (act("trapped_nan")) { volatile double zero = 0.0; u->y = zero / zero; }
    if (act("close_output")) close(1), close(2);
    if (act("flood")) { static char line[1 << 20]; memset(line, '*', sizeof line); for (int i = 0; i < 4; i++) fwrite(line, 1, sizeof line, i % 2 ? stdout : stderr); }
    if (act("log_flood")) for (int i = 0; i < 5000; i++) tell(u, OK, "one of very many");
    if (act("log_null")) tell(u, WARNING, NULL);
    if (act("log_percent")) tell(u, WARNING, "the battery is at 100 %");
#if FMI == 3
    if (act("log_format")) tell(u, WARNING, "%s %s %n");
#else
    if (act("log_format")) u->log(FMI == 1 ? (void *)u : u->environment, "bad", WARNING, "log", "%s", (char *)1);
#endif
    if (act("reads_input") && getchar() != EOF) abort();
    if (act("own_files")) write_own_library();
    if (act("log_not_utf8")) tell(u, ERROR, "caf\xe9 \xff\xfe");
    if (act("log_escapes")) tell(u, ERROR, "\x1b[2J\x1b]0;title\x07\rover\x9b\x7f\nwritten");
    if (act("marks")) tell(u, WARNING, "warned \x1b[31m\xe2\x80\xae\x07\tred\r\xc2\x9b\nevcosim: all is well");
    if (act("log_status")) tell(u, 99, "of no status");
    if (act("log_long")) { char *text = malloc(1 << 22); memset(text, 'x', (1 << 22) - 1); text[(1 << 22) - 1] = 0; tell(u, WARNING, text); free(text); }
    if (act("log_foreign")) { void *mine = u->environment; u->environment = (void *)0xdeadbeef; tell(u, WARNING, "to nobody"); u->environment = mine; }
    if (act("log_thread")) { pthread_t other; pthread_create(&other, NULL, tell_from_a_thread, u); pthread_join(other, NULL); }
}

static int step(Unit *u, double h) {
    bool late = u->time >= 0.0499;
    if (late) end(), disturb(u);
    if (act("stiff")) u->y += 1900.0 * h * (u->u - u->y);
    else u->y += h * (u->gain * u->u - u->y);
    u->n++;
    u->time += h;
    if (!late) return act("warning") ? WARNING : OK;
    if (act("nan")) u->y = NAN;
    if (act("infinity")) u->y = INFINITY;
    if (act("huge")) u->y = 1e69;
    if (act("out_of_range")) u->y = -4.6e5;
    if (act("warning") || act("marks")) return WARNING;
    if (act("discard")) return DISCARD;
    if (act("error") || act("log_not_utf8") || act("log_escapes")) return ERROR;
    if (act("fatal") || act("fatal_crash_in_free")) return FATAL;
    if (act("pending")) return PENDING;
    if (act("status42")) return 42;
    if (act("status_negative")) return -1;
    return OK;
}

/* The token is that of any behavior; "refuse" is one that the library does not accept. */
static Unit *instantiate(const char *token, Logger log, void *environment) {
    const char *word = token ? strchr(token, ':') : NULL;
    if (!word) {
        Unit stranger = {.log = log, .environment = environment};
        tell(&stranger, ERROR, "wrong GUID");
        return NULL;
    }
    snprintf(act_, sizeof act_, "%s", word + 1);
    Unit *u = calloc(1, sizeof(Unit));
    u->gain = 1.0, u->log = log, u->environment = environment;
    if (act("banner")) { puts("*** the banner of a tool ***"); fputs("*** and of its license ***\n", stderr); fflush(stdout); }
    if (act("instantiate_refuse")) { tell(u, ERROR, "no license: call 555-0100"); return NULL; }
    if (act("instantiate_silent")) return NULL;
    if (act("instantiate_crash")) *nowhere = 1;
    if (act("instantiate_exit")) exit(0);
    if (act("instantiate_hang")) hang();
    if (act("instantiate_nonsense")) return (void *)1;
    return u;
}

static int initialize(double start, Unit *u) {
    u->time = start;
    if (act("initialize_error")) { tell(u, ERROR, "no steady state"); return ERROR; }
    if (act("initialize_crash")) *nowhere = 1;
    if (act("initialize_hang")) hang();
    if (act("initialize_nan")) u->y = NAN;
    return OK;
}

static int terminate(void) {
    if (act("terminate_crash")) *nowhere = 1;
    if (act("terminate_hang")) hang();
    return act("terminate_error") ? ERROR : OK;
}

static void release(Unit *u) {
    if (act("free_crash") || act("fatal_crash_in_free")) *nowhere = 1;
    if (act("free_exit")) exit(0);
    if (act("free_hang")) hang();
    free(u);
}

__attribute__((constructor)) static void loading(void) {
#ifdef LOADING
    if (LOADING == 1) *nowhere = 1;
    if (LOADING == 2) exit(0);
    if (LOADING == 3) hang();
#endif
}

#define CAT_(a, b) a##b
#define CAT(a, b) CAT_(a, b)
#if FMI == 1
#define F(name) CAT(hostile_fmi, name)
typedef char Boolean;
#elif FMI == 2
#define F(name) CAT(fmi2, name)
typedef int Boolean;
#else
#define F(name) CAT(fmi3, name)
typedef bool Boolean;
#endif

#if FMI == 3
#define REAL Float64
#define INTEGER Int32
#define EXTRA , size_t m
#else
#define REAL Real
#define INTEGER Integer
#define EXTRA
#endif

EXPORT int CAT(F(Get), REAL)(Unit *c, const Reference *r, size_t n, double *x EXTRA) {
    if (act("get_error")) return ERROR;
    for (size_t i = 0; i < n; i++) x[i] = r[i] == Y ? c->y : r[i] == U ? c->u : c->gain;
    if (act("write_beyond") && c->n >= 6) for (size_t i = 0; i < 1 << 27; i++) x[i] = 1.0;
    if (act("write_before") && c->n >= 6) x[-1] = 1e9;
    return OK;
}
EXPORT int CAT(F(Set), REAL)(Unit *c, const Reference *r, size_t n, double *x EXTRA) {
    if (act("set_error")) return ERROR;
    for (size_t i = 0; i < n; i++) if (r[i] == U) c->u = x[i]; else if (r[i] == GAIN) c->gain = x[i];
    if (act("change_inputs")) for (size_t i = 0; i < n; i++) x[i] = 1e9;
    return OK;
}
EXPORT int CAT(F(Get), INTEGER)(Unit *c, const Reference *r, size_t n, int *x EXTRA) {
    for (size_t i = 0; i < n; i++) x[i] = act("integer_minimum") ? INT32_MIN : c->n;
    return OK;
}
EXPORT int F(GetBoolean)(Unit *c, const Reference *r, size_t n, Boolean *x EXTRA) {
    for (size_t i = 0; i < n; i++) *(char *)(x + i) = act("odd_boolean") ? 77 : 1;
    return OK;
}
EXPORT int F(GetString)(Unit *c, const Reference *r, size_t n, const char **x EXTRA) {
    for (size_t i = 0; i < n; i++) x[i] = act("null_string") ? NULL : act("marks") ? "text\x1b]0;title\x07\xe2\x80\xae\xe2\x80\x8b" : "text";
    return OK;
}

#if FMI < 3
typedef struct {
    Logger logger;
    void *(*allocate)(size_t, size_t);
    void (*release)(void *);
    void (*finished)(void *, int);
    void *environment; /* not in FMI 1.0 */
} Callbacks;
#endif

#if FMI == 1
typedef struct { Logger logger; void *(*allocate)(size_t, size_t); void (*release)(void *); void (*finished)(void *, int); } Callbacks1;

EXPORT void *F(InstantiateSlave)(const char *name, const char *guid, const char *location, const char *mime,
                                 double timeout, char visible, char interactive, Callbacks1 callbacks, char logging) {
    return instantiate(guid, callbacks.logger, NULL);
}
EXPORT int F(InitializeSlave)(Unit *c, double start, char stop_defined, double stop) { return initialize(start, c); }
EXPORT int F(DoStep)(Unit *c, double t, double h, char new_step) { return step(c, h); }
EXPORT int F(TerminateSlave)(Unit *c) { return terminate(); }
EXPORT void F(FreeSlaveInstance)(Unit *c) { release(c); }
#elif FMI == 2
EXPORT void *F(Instantiate)(const char *name, int type, const char *guid, const char *resources,
                            const Callbacks *callbacks, int visible, int logging) {
    return instantiate(guid, callbacks->logger, callbacks->environment);
}
EXPORT int F(SetupExperiment)(Unit *c, int td, double tolerance, double start, int sd, double stop) {
    return initialize(start, c);
}
EXPORT int F(EnterInitializationMode)(Unit *c) { return OK; }
EXPORT int F(ExitInitializationMode)(Unit *c) { return OK; }
EXPORT int F(DoStep)(Unit *c, double t, double h, int no_set_state) { return step(c, h); }
EXPORT int F(Terminate)(Unit *c) { return terminate(); }
EXPORT void F(FreeInstance)(Unit *c) { release(c); }
#else
EXPORT void *F(InstantiateCoSimulation)(const char *name, const char *token, const char *resources, bool visible,
                                        bool logging, bool events, bool early, const Reference *r, size_t n,
                                        void *environment, Logger log, void *update) {
    return instantiate(token, log, environment);
}
EXPORT int F(EnterInitializationMode)(Unit *c, bool td, double tolerance, double start, bool sd, double stop) {
    return initialize(start, c);
}
EXPORT int F(ExitInitializationMode)(Unit *c) { return OK; }
EXPORT int F(DoStep)(Unit *c, double t, double h, bool no_set_state, bool *event, bool *end, bool *early,
                     double *reached) {
    bool late = c->time >= 0.0499;
    int status = step(c, h);
    *event = late && act("event");
    *end = false;
    *early = late && (act("early_return") || act("backwards"));
    *reached = act("backwards") ? t - 1.0 : act("early_return") ? t + h / 2.0 : t + h;
    return status;
}
EXPORT int F(Terminate)(Unit *c) { return terminate(); }
EXPORT void F(FreeInstance)(Unit *c) { release(c); }
#endif
