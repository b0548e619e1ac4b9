/* Random sequences of legal and illegal calls of the FMU runtime. Every call must return OK with all values written and
 * finite, or Error with one message that names the function; no crash, no memory leak.
 * Arguments: a scratch folder, how many calls, and folders of resources (see tests/fmu_resources.py), as absolute paths.
 * Builds as tests/fmu_check.c does. Prints one line; at the first failed assertion it prints that and exits with status 1. */
#include "fmu_fuzz_absent.h"

/* ---------------------------------------------------------------- making instances */

static void try_to_make(player *p, const resources *r) {
    const char *name = likely(95) ? "fuzz" : likely(50) ? "" : NULL;
    const char *token = likely(95) ? r->data.token : likely(50) ? "{no such}" : NULL;
    unsigned wanted[VARIABLES] = {0};
    size_t count = likely(2) ? 1 : 0;
    long before = messages;
    memset(p, 0, sizeof *p);
    p->u.version = whole(2, 3);
    p->u.interface = whole(COSIMULATION, EXCHANGE);
    p->u.from = r;
    p->silent = likely(5);
    static const fmi2CallbackFunctions silence = {NULL, NULL, NULL, NULL, NULL};
    if (p->u.version == 2) {
        static const char *const uris[] = {NULL, "", "file:", "file://", "file:///%zz", "file:///a%00b", "http://a/b", "file://a/b", "/tmp"};
        const char *uri = likely(95) ? r->uri : uris[whole(0, 8)];
        const fmi2CallbackFunctions *functions = !p->silent ? &CALLBACKS : likely(50) ? &silence : NULL;
        p->u.c = fmi2Instantiate(name, p->u.interface == EXCHANGE ? fmi2ModelExchange : fmi2CoSimulation, token, uri, functions,
                                 fmi2False, likely(50));
    } else {
        const char *path = likely(95) ? r->path : likely(30) ? NULL : likely(50) ? "" : "/no/such/folder";
        p->updated = likely(60);
        for (unsigned k = EXTERNAL_FORCE; k <= KINETIC_ENERGY; k++)
            if (p->updated && has(r, k) && VARIABLE[k].role[r->data.kind] != PARAMETER && likely(60)) wanted[count++] = k;
        fmi3LogMessageCallback logger = p->silent ? NULL : logger_3;
        if (likely(2))
            p->u.c = fmi3InstantiateScheduledExecution(name, token, path, fmi3False, fmi3False, NULL, logger, NULL, NULL, NULL);
        else if (p->u.interface == EXCHANGE)
            p->u.c = fmi3InstantiateModelExchange(name, token, path, fmi3False, likely(50), NULL, logger);
        else
            p->u.c = fmi3InstantiateCoSimulation(name, token, path, fmi3False, likely(50), p->u.interface != COSIMULATION,
                                                 p->u.interface == EARLY_RETURN, likely(99) ? wanted : NULL, count, NULL, logger,
                                                 p->updated ? any_update : NULL);
    }
    if (p->u.c || p->silent) HOLD(messages == before);
    else HOLD(messages == before + 1 && last_status == ERROR && strncmp(last_message, "fmi", 3) == 0 && strstr(last_message, ": "));
}

/* ---------------------------------------------------------------- sequences of calls */

static void call_end(player *p) {
    int status;
    switch (whole(0, 3)) {
    case 0:
        dispose(&p->u);
        if (likely(10)) { /* without an instance every call returns Error */
            call_get(p);
            call_event_mode(p);
            dispose(&p->u);
        }
        break;
    case 1: EITHER_CALL(p, fmi2Terminate, (p->u.c), fmi3Terminate, (p->u.c)); break;
    default: EITHER_CALL(p, fmi2Reset, (p->u.c), fmi3Reset, (p->u.c)); break;
    }
}

/* Go straight to a mode in which most calls are allowed. */
static void call_legal_start(player *p) {
    if (((instance *)p->u.c)->state.mode != INSTANTIATED) return;
    double start = uniform(-1.0, 1.0);
    int status;
    if (p->u.version == 2) CALL(p, fmi2SetupExperiment, p->u.c, fmi2False, 0.0, start, fmi2False, 0.0);
    EITHER_CALL(p, fmi2EnterInitializationMode, (p->u.c), fmi3EnterInitializationMode, (p->u.c, fmi3False, 0.0, start, fmi3False, 0.0));
    if (status == GOOD) EITHER_CALL(p, fmi2ExitInitializationMode, (p->u.c), fmi3ExitInitializationMode, (p->u.c));
    if (status == GOOD && ((instance *)p->u.c)->state.mode == EVENT) {
        call_update(p);
        call_leave(p);
    }
}

static void call_something(player *p) {
    static void (*const frequent[])(player *) = {call_step, call_set, call_get, call_exchange, call_rates};
    static void (*const all[])(player *) = {call_event_mode, call_update, call_leave, call_initialization, call_legal_start,
                                            call_state, call_state, call_derivative, call_absent};
    if (!p->u.c) {
        try_to_make(p, &folder[whole(0, folders - 1)]);
        return;
    }
    snprintf(where, sizeof where, "a sequence: FMI %d, interface %d, state %d, %.200s", p->u.version, p->u.interface,
             ((instance *)p->u.c)->state.mode, p->u.from->path);
    if (likely(1)) call_end(p);
    else if (likely(60)) frequent[whole(0, (int)(sizeof frequent / sizeof *frequent) - 1)](p);
    else all[whole(0, (int)(sizeof all / sizeof *all) - 1)](p);
    if (p->u.c && ((instance *)p->u.c)->state.mode & (FAILED | TERMINATED) && likely(20)) {
        int status;
        EITHER_CALL(p, fmi2Reset, (p->u.c), fmi3Reset, (p->u.c));
    }
}

/* ---------------------------------------------------------------- damaged files */

static void write_damaged(const char *scratch, const model_data *data, size_t size) {
    char path[1100];
    snprintf(path, sizeof path, "%s/model.film", scratch);
    FILE *file = fopen(path, "wb");
    HOLD(file && fwrite(data, 1, size, file) == size && fclose(file) == 0);
}

/* A file that is cut, or has wrong bytes, with or without a matching checksum: an error, or an instance that never crashes. */
static void damaged_file(const char *scratch, const resources *r, int kind) {
    static resources other; /* static: large */
    size_t size = (size_t)r->data.size, head = offsetof(model_data, token), tail = sizeof(model_data);
    size_t used = offsetof(model_data, curve) + offsetof(film_curve, piece) + (size_t)r->data.curve.pieces * sizeof(film_piece);
    model_data *data = malloc(size);
    HOLD(data != NULL);
    memcpy(data, r->file, size);
    if (kind == 0) size = (size_t)whole(0, (int)size - 1);
    else
        for (int flips = whole(1, 3); flips > 0; flips--) {
            size_t at = (size_t)whole((int)head + 64, (int)used - 1);
            if (kind == 1) at = (size_t)whole(0, (int)size - 1);
            else if (likely(40) && beside(r)) at = (size_t)whole((int)offsetof(model_data, family), (int)size - 1);
            else if (likely(20) && size > tail) at = (size_t)whole((int)tail, (int)size - 1);
            ((unsigned char *)data)[at] ^= (unsigned char)(1 << whole(0, 7));
        }
    if (kind == 2) data->checksum = model_checksum((const unsigned char *)data + head, size - head);
    write_damaged(scratch, data, size);
    damaged++;
    memcpy(&other, r, sizeof other);
    memcpy(&other.data, data, sizeof other.data);
    free(data);
    snprintf(other.path, sizeof other.path, "%s", scratch);
    snprintf(other.uri, sizeof other.uri, "file://%s", scratch);
    unit made = make(whole(2, 3), whole(0, 1) || !exchanges(&other) ? COSIMULATION : EXCHANGE, &other);
    snprintf(where, sizeof where, "a damaged file, kind %d, of %.200s", kind, r->path);
    if (!made.c) {
        HOLD(strstr(last_message, "model.film") && strncmp(last_message, "fmi", 3) == 0);
        return;
    }
    HOLD(kind == 2);
    player p;
    memset(&p, 0, sizeof p);
    p.u = made;
    call_legal_start(&p);
    for (int k = 0; k < 30; k++) {
        if (made.interface == EXCHANGE) call_exchange(&p);
        else call_step(&p);
        call_get(&p);
    }
    dispose(&p.u);
}

int main(int count, char **argument) {
    long calls = count > 3 ? atol(argument[2]) : 0;
    HOLD(strcmp(fmi2GetVersion(), "2.0") == 0 && strcmp(fmi3GetVersion(), "3.0") == 0 && strcmp(fmi2GetTypesPlatform(), "default") == 0);
    if (calls < 1 || count > MOST_FOLDERS) {
        printf("usage: fmu_fuzz SCRATCH CALLS FOLDER...\n");
        return 2;
    }
    folders = count - 3;
    folder = calloc((size_t)folders, sizeof *folder);
    for (int k = 0; k < folders; k++) open_resources(&folder[k], argument[k + 3]);
    for (long k = 0; k < calls; k++) call_something(&players[whole(0, UNITS - 1)]);
    for (long k = 0; k < calls / 300; k++) damaged_file(argument[1], &folder[k % folders], (int)(k % 5 < 2 ? k % 5 : 2));
    for (int k = 0; k < SAVED; k++) {
        fmi3FMUState state = saves[k].state;
        player any;
        memset(&any, 0, sizeof any);
        while (!any.u.c) try_to_make(&any, &folder[0]);
        HOLD(forget(&any.u, &state) == GOOD);
        dispose(&any.u);
        free(bytes[k]);
    }
    for (int k = 0; k < UNITS; k++) dispose(&players[k].u);
    close_resources(folder, folders);
    snprintf(where, sizeof where, "the end");
    detail[0] = 0;
    HOLD(blocks == 0);
    printf("fmu_fuzz: %ld calls, %ld intermediate updates, %ld calls good, %ld refused, %ld damaged files and states\n", calls, updates,
           good, refused, damaged);
    return 0;
}
