/* Runs the scenes of scenes.h on another system and prints the outputs after every step: scene, step, values.
 *
 * On Windows the program loads the library like a host and needs only the runtime of the system. On other systems
 * the FMU is linked with this program. Both call functions through pointers.
 */
#include "fmi2Functions.h"
#include "model.h"
#include "scenes.h"

#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <string.h>

struct fmu {
    fmi2InstantiateTYPE *instantiate;
    fmi2FreeInstanceTYPE *free_instance;
    fmi2SetupExperimentTYPE *setup;
    fmi2EnterInitializationModeTYPE *enter;
    fmi2ExitInitializationModeTYPE *leave;
    fmi2SetRealTYPE *set_real;
    fmi2SetIntegerTYPE *set_integer;
    fmi2SetBooleanTYPE *set_boolean;
    fmi2GetRealTYPE *get_real;
    fmi2DoStepTYPE *step;
};

#ifdef _WIN32
__declspec(dllimport) void *__stdcall LoadLibraryA(const char *path);
__declspec(dllimport) void *__stdcall GetProcAddress(void *library, const char *name);
__declspec(dllimport) int __stdcall FreeLibrary(void *library);
__declspec(dllimport) void *__stdcall GetStdHandle(unsigned long which);
__declspec(dllimport) int __stdcall WriteFile(void *file, const void *bytes, unsigned long count,
                                              unsigned long *written, void *overlapped);
__declspec(dllimport) void __stdcall ExitProcess(unsigned status);
void begin(void);

static void write_text(const char *text)
{
    unsigned long written;
    WriteFile(GetStdHandle(-11UL), text, (unsigned long)strlen(text), &written, NULL);
}

/* Convert the result of GetProcAddress to a function pointer. */
static int find(void *library, const char *name, void *pointer)
{
    void *const found = GetProcAddress(library, name);
    memcpy(pointer, &found, sizeof found);
    return found != NULL;
}

#define FIND(name, member) (find(library, #name, &fmu->member))
static int load(struct fmu *fmu)
{
    void *const library = LoadLibraryA(LIBRARY);
    return library && FIND(fmi2Instantiate, instantiate) && FIND(fmi2FreeInstance, free_instance) &&
           FIND(fmi2SetupExperiment, setup) && FIND(fmi2EnterInitializationMode, enter) &&
           FIND(fmi2ExitInitializationMode, leave) && FIND(fmi2SetReal, set_real) &&
           FIND(fmi2SetInteger, set_integer) && FIND(fmi2SetBoolean, set_boolean) && FIND(fmi2GetReal, get_real) &&
           FIND(fmi2DoStep, step);
}
#else
static void write_text(const char *text)
{
    fputs(text, stdout);
}

static int load(struct fmu *fmu)
{
    *fmu = (struct fmu){fmi2Instantiate, fmi2FreeInstance, fmi2SetupExperiment, fmi2EnterInitializationMode,
                        fmi2ExitInitializationMode, fmi2SetReal, fmi2SetInteger, fmi2SetBoolean, fmi2GetReal,
                        fmi2DoStep};
    return 1;
}
#endif

static void logger(fmi2ComponentEnvironment environment, fmi2String name, fmi2Status status, fmi2String category,
                   fmi2String message, ...)
{
    (void)environment;
    (void)status;
    write_text(name);
    write_text(category);
    write_text(message);
    write_text("\n");
}

static int set(const struct fmu *fmu, fmi2Component c, const struct setting *setting)
{
    const fmi2Integer whole = (fmi2Integer)setting->value;
    for (fmi2ValueReference n = 0; n < model.variable_count; n++) {
        if (strcmp(model.variables[n].name, setting->name) != 0)
            continue;
        if (model.variables[n].kind == REAL)
            return fmu->set_real(c, &n, 1, &setting->value) == fmi2OK;
        return (model.variables[n].kind == BOOLEAN ? fmu->set_boolean : fmu->set_integer)(c, &n, 1, &whole) == fmi2OK;
    }
    return 0;
}

static int print_outputs(const struct fmu *fmu, fmi2Component c, const struct scene *scene, int step)
{
    char text[64];
    snprintf(text, sizeof text, "%s %d", scene->name, step);
    write_text(text);
    for (fmi2ValueReference n = 0; n < model.variable_count; n++) {
        fmi2Real value;
        if (model.variables[n].kind != REAL || model.variables[n].array != OUTPUTS)
            continue;
        if (fmu->get_real(c, &n, 1, &value) != fmi2OK)
            return 0;
        snprintf(text, sizeof text, " %.17g", value);
        write_text(text);
    }
    write_text("\n");
    return 1;
}

static int run(const struct fmu *fmu, const struct scene *scene)
{
    const fmi2CallbackFunctions callbacks = {logger, NULL, NULL, NULL, NULL};
    const fmi2Component c =
        fmu->instantiate(scene->name, fmi2CoSimulation, model.guid, "", &callbacks, fmi2False, fmi2True);
    int good = c != NULL && fmu->setup(c, fmi2False, 0.0, 0.0, fmi2False, 0.0) == fmi2OK;
    for (const struct setting *setting = scene->settings; good && setting->name; setting++)
        good = set(fmu, c, setting);
    good = good && fmu->enter(c) == fmi2OK && fmu->leave(c) == fmi2OK && print_outputs(fmu, c, scene, 0);
    for (int n = 0; good && n < scene->steps; n++)
        good = fmu->step(c, n * scene->step, scene->step, fmi2True) == fmi2OK && print_outputs(fmu, c, scene, n + 1);
    if (c)
        fmu->free_instance(c);
    return good;
}

static int run_all(void)
{
    struct fmu fmu;
    int good = load(&fmu);
    for (size_t n = 0; good && n < sizeof scenes / sizeof *scenes; n++)
        good = run(&fmu, &scenes[n]);
    write_text(good ? "done\n" : "failed\n");
    return good ? 0 : 1;
}

#ifdef _WIN32
void begin(void)
{
    ExitProcess((unsigned)run_all());
}
#else
int main(void)
{
    return run_all();
}
#endif
