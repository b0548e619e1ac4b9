/* Read the data of an export. See model.h. */
#include "model.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#if defined(_WIN32)
#define WIN32_LEAN_AND_MEAN
#define NOUSER /* without winuser.h, whose INPUT conflicts with that of variables.h */
#include <windows.h>
#endif

static const char MAGIC[8] = {'F', 'I', 'L', 'M', 'F', 'M', 'U', '6'};
static const char NAME[] = "model.film";
enum { LONGEST_PATH = 4096, LARGEST_FILE = 1 << 25, MOST_VARYING = 1 << 13, MOST_MODES = 20000 };

static const double LEAST_TOLERANCE = 1e-14; /* of a step; for less, rounding makes its steps too short */

static FILE *open_file(const char *path) {
#if defined(_WIN32)
    wchar_t wide[LONGEST_PATH];
    return MultiByteToWideChar(CP_UTF8, 0, path, -1, wide, LONGEST_PATH) > 0 ? _wfopen(wide, L"rb") : NULL;
#else
    return fopen(path, "rb");
#endif
}

uint64_t model_checksum(const void *from, size_t count) {
    const unsigned char *bytes = from;
    uint64_t hash = 14695981039346656037u;
    for (size_t k = 0; k < count; k += sizeof hash) {
        uint64_t word = 0;
        memcpy(&word, bytes + k, count - k < sizeof word ? count - k : sizeof word);
        hash = (hash ^ word) * 1099511628211u;
    }
    return hash;
}

static model_data *fault(model_data *data, FILE *file, char *message, size_t room, const char *format, ...) {
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(message, room, format, arguments);
    va_end(arguments);
    if (file) fclose(file);
    free(data);
    return NULL;
}

static int bad_modes(const model_data *data) {
    const model_modes *modes = &data->modes;
    size_t count = (size_t)modes->count;
    if (count == 0) return 0;
    const double *numbers = (const double *)((const unsigned char *)data + data->size) - 3 * count;
    for (size_t k = 1; k <= (size_t)modes->sensors * count; k++)
        if (!isfinite(*(numbers - k))) return 1;
    double time = sqrt(data->start[MASS] * data->length_scale / data->force_scale);
    return data->kind != IMPACT || !(modes->longest >= time && modes->longest < 2.0 * time) ||
           !(modes->tolerance >= LEAST_TOLERANCE && modes->tolerance <= 1.0) ||
           !(modes->rest >= 0.0 && modes->rest < INFINITY) || (modes->rest > 0.0 && data->curve.stage[0].damped) ||
           modes->levels < 1 || modes->levels > FILM_LEVELS ||
           film_check_modes(modes->count, numbers, numbers + count, numbers + 2 * count) < 0;
}

static int bad_relaxation(const model_data *data) {
    const model_relaxation *own = &data->relaxation;
    static const film_start still = {0.0, 0.0, 0.0, 0.0, INFINITY, 0.0};
    const film_function *force = &data->curve.piece[0].force;
    film_relax state;
    if (own->tolerance == 0.0) return 0;
    int hertz = data->curve.stages == 1 && data->curve.pieces == 1 && force->form == FILM_POWER && force->exponent == 1.5 &&
                !data->curve.stage[0].damped;
    return data->kind != IMPACT || data->modes.count > 0 || data->available[TARGET_STIFFNESS] || !hertz ||
           !(own->tolerance >= LEAST_TOLERANCE && own->tolerance <= 1.0) ||
           film_relax_init(&state, &own->law, &still, own->tolerance, 0.0) < 0;
}

static int bad_friction(const model_data *data) {
    const model_friction *own = &data->friction;
    if (!data->available[TORQUE]) return own->rows != 0;
    if (own->rows < 0 || own->rows > MOST_ROWS) return 1;
    int bad = !(own->ratio > 0.0 && own->ratio < INFINITY && own->lever > 0.0 && own->lever < INFINITY && own->inertia > 0.0 &&
                own->inertia < INFINITY);
    const double *table = model_friction_table(data);
    for (int32_t k = 0; k < 2 * own->rows; k++) bad |= !(table[k] >= 0.0 && table[k] < INFINITY);
    for (int32_t k = 1; k < own->rows; k++) bad |= !(table[2 * k] > table[2 * k - 2]);
    return bad || data->kind != IMPACT || data->relaxation.tolerance > 0.0 || data->curve.pull > 0.0;
}

static int bad_numbers(const model_data *data) {
    int bad = data->kind < 0 || data->kind >= KINDS || !(data->length_scale > 0.0) || !(data->force_scale > 0.0) ||
              !(data->damping >= 0.0);
    for (unsigned k = 0; k < SETTABLE; k++)
        bad |= !(data->start[k] >= VARIABLE[k].low && data->start[k] <= VARIABLE[k].high);
    for (int k = 0; k < RESTITUTION_TERMS; k++) bad |= !isfinite(data->restitution[k]);
    const double *number = (const double *)&data->stresses;
    for (size_t k = 0; k < sizeof data->stresses / sizeof *number; k++) bad |= !(number[k] >= 0.0 && number[k] < INFINITY);
    const model_family *family = &data->family;
    if (family->nodes != 0)
        bad |= family->nodes < 2 || family->nodes > FILM_MAX_NODES || !(family->low > 0.0 && family->low < family->high) ||
               !(family->shape >= family->low && family->shape <= family->high) || family->varying < 1;
    return bad || film_check_curve(&data->curve) < 0 || bad_modes(data) || bad_relaxation(data) || bad_friction(data);
}

/* Bytes of the family that follow the data. */
static size_t family_size(const model_data *data) {
    size_t nodes = (size_t)data->family.nodes, varying = (size_t)data->family.varying;
    if (data->family.nodes <= 0 || data->family.nodes > FILM_MAX_NODES || varying > MOST_VARYING) return 0;
    return sizeof(film_curve) + (nodes + varying + nodes * varying) * sizeof(double);
}

/* Bytes of the table of friction that follow those. */
static size_t friction_size(const model_data *data) {
    int32_t rows = data->friction.rows;
    return rows > 0 && rows <= MOST_ROWS ? 2 * sizeof(double) * (size_t)rows : 0;
}

/* Bytes of the modes that follow those. */
static size_t modes_size(const model_data *data) {
    const model_modes *modes = &data->modes;
    int sound = modes->count > 0 && modes->count <= MOST_MODES && modes->sensors >= 0 && modes->sensors <= MOST_SENSORS;
    return sound ? (size_t)(modes->sensors + 3) * sizeof(double) * (size_t)modes->count : 0;
}

model_data *model_read_data(const char *folder, char *message, size_t room) {
    char path[LONGEST_PATH];
    if (!folder || !*folder) return fault(NULL, NULL, message, room, "the path of the resources folder, which contains %s, is missing", NAME);
    size_t length = strlen(folder);
    const char *slash = folder[length - 1] == '/' || folder[length - 1] == '\\' ? "" : "/";
    if (length + sizeof NAME + 2 > sizeof path) return fault(NULL, NULL, message, room, "the path of the resources folder is too long");
    snprintf(path, sizeof path, "%s%s%s", folder, slash, NAME);
    FILE *file = open_file(path);
    if (!file) return fault(NULL, NULL, message, room, "%s cannot be opened", path);
    if (fseek(file, 0, SEEK_END) != 0) return fault(NULL, file, message, room, "%s cannot be read", path);
    long bytes = ftell(file);
    if (bytes < (long)sizeof(model_data) || bytes > LARGEST_FILE)
        return fault(NULL, file, message, room, "%s is damaged: it must have at least %u bytes", path, (unsigned)sizeof(model_data));
    rewind(file);
    size_t size = (size_t)bytes;
    model_data *data = malloc(size);
    if (!data) return fault(NULL, file, message, room, "no memory for %s", path);
    if (fread(data, 1, size, file) < size) return fault(data, file, message, room, "%s cannot be read", path);
    if (memcmp(data->magic, MAGIC, sizeof MAGIC) != 0)
        return fault(data, file, message, room, "%s was not written by this version of film-model", path);
    if (data->size != size || size != sizeof *data + family_size(data) + friction_size(data) + modes_size(data) ||
        data->modes.count < 0 || data->modes.count > MOST_MODES || data->modes.sensors < 0 || data->modes.sensors > MOST_SENSORS)
        return fault(data, file, message, room, "%s is damaged: it must have %u bytes", path, (unsigned)data->size);
    size_t head = offsetof(model_data, token);
    if (data->checksum != model_checksum((const unsigned char *)data + head, size - head) ||
        memchr(data->token, 0, sizeof data->token) == NULL || bad_numbers(data))
        return fault(data, file, message, room, "%s is damaged: its checksum or its numbers are wrong", path);
    fclose(file);
    return data;
}

int model_has_data(const char *folder) {
    char path[LONGEST_PATH];
    if ((size_t)snprintf(path, sizeof path, "%s/%s", folder, NAME) >= sizeof path) return 0;
    FILE *file = open_file(path);
    if (file) fclose(file);
    return file != NULL;
}

static int digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    return c >= 'A' && c <= 'F' ? c - 'A' + 10 : -1;
}

int model_path_of_uri(const char *uri, char *path, size_t room, int escapes) {
    if (!uri || strncmp(uri, "file:", 5) != 0) return -1;
    const char *from = uri + 5;
    if (strncmp(from, "//", 2) == 0) {
        from += 2;
        if (strncmp(from, "localhost/", 10) == 0) from += 9;
        if (*from != '/') return -1; /* another machine */
    }
    if (from[0] == '/' && from[1] != 0 && from[2] == ':') from++; /* /C:/... */
    size_t count = 0;
    for (; *from; from++) {
        char c = *from;
        if (escapes && c == '%') {
            int high = digit(from[1]), low = high < 0 ? -1 : digit(from[2]);
            if (low < 0 || high * 16 + low == 0) return -1;
            c = (char)(high * 16 + low);
            from += 2;
        }
        if (count + 1 >= room) return -1;
        path[count++] = c;
    }
    path[count] = 0;
    return count > 0 ? 0 : -1;
}
