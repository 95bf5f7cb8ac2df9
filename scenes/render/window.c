#include "scenes/render/window.h"

#include "ref/base/symbols.h"
#include "scenes/render/turning.h"

#include "have_sdl2.h"

#if HAVE_SDL2

#include <SDL2/SDL.h>
#include <dlfcn.h>
#include <stdlib.h>

/* All SDL functions used, without the prefix SDL_, to be looked up in the library. */
#define SDL_FUNCTIONS(X)                                                                           \
    X(SetHint)                                                                                     \
    X(Init)                                                                                        \
    X(Quit)                                                                                        \
    X(GetError)                                                                                    \
    X(GetTicks)                                                                                    \
    X(CreateWindow)                                                                                \
    X(DestroyWindow)                                                                               \
    X(SetWindowTitle)                                                                              \
    X(GetWindowSize)                                                                               \
    X(GetWindowSurface)                                                                            \
    X(UpdateWindowSurface)                                                                         \
    X(CreateRGBSurfaceWithFormatFrom)                                                              \
    X(FreeSurface)                                                                                 \
    X(SetSurfaceBlendMode)                                                                         \
    X(UpperBlitScaled)                                                                             \
    X(WaitEventTimeout)                                                                            \
    X(PollEvent)

struct sdl {
#define SDL_MEMBER(name) __typeof__(SDL_##name) *name;
    SDL_FUNCTIONS(SDL_MEMBER)
#undef SDL_MEMBER
};

struct window {
    struct sdl sdl;
    SDL_Window *shown;
    struct turning turning;
};

/* The library is not closed before the program ends: it leaves threads and memory behind, which a
 * leak checker could not attribute after dlclose. */
static enum status sdl_load(struct sdl *sdl, struct reason *reason)
{
    static const char library[] = "libSDL2-2.0.so.0";
    void *handle = dlopen(library, RTLD_NOW | RTLD_LOCAL);
    if (!handle)
        return fail(reason, STATUS_UNSUPPORTED, "no window: %s cannot be opened (libsdl2-2.0-0)",
                    library);
    static const struct symbol functions[] = {
#define SDL_ENTRY(name) {"SDL_" #name, offsetof(struct sdl, name)},
        SDL_FUNCTIONS(SDL_ENTRY)
#undef SDL_ENTRY
    };
    const char *lacks = symbols_find(handle, functions, ARRAY_COUNT(functions), sdl);
    return lacks ? fail(reason, STATUS_UNSUPPORTED, "no window: %s has no %s", library, lacks)
                 : STATUS_OK;
}

/* Without a display SDL would open an invisible window or use the console. */
static enum status choose_display(const struct sdl *sdl, struct reason *reason)
{
    const char *x11 = getenv("DISPLAY"), *wayland = getenv("WAYLAND_DISPLAY");
    bool has_x11 = x11 && *x11, has_wayland = wayland && *wayland;
    if (getenv("SDL_VIDEODRIVER")) /* the user's choice */
        return STATUS_OK;
    if (!has_x11 && !has_wayland)
        return fail(reason, STATUS_UNSUPPORTED,
                    "no window: no display, neither DISPLAY nor WAYLAND_DISPLAY is set");
    sdl->SetHint("SDL_VIDEODRIVER", has_x11 && has_wayland ? "x11,wayland"
                                    : has_x11              ? "x11"
                                                           : "wayland");
    return STATUS_OK;
}

enum status window_open(const char *title, uint32_t width, uint32_t height, struct window **out,
                        struct reason *reason)
{
    *out = NULL;
    struct window *window = alloc_zeroed(1, sizeof *window);
    if (!window)
        return fail(reason, STATUS_MEMORY, "no memory for a window");
    enum status status = sdl_load(&window->sdl, reason);
    if (!status)
        status = choose_display(&window->sdl, reason);
    if (status) {
        free(window);
        return status;
    }
    const struct sdl *sdl = &window->sdl;
    sdl->SetHint(SDL_HINT_FRAMEBUFFER_ACCELERATION, "0"); /* no OpenGL for a finished picture */
    if (sdl->Init(SDL_INIT_VIDEO) != 0) {
        status = fail(reason, STATUS_UNSUPPORTED, "no window: no display can be opened (SDL: %s)",
                      sdl->GetError());
        free(window);
        return status;
    }
    window->shown = sdl->CreateWindow(title, SDL_WINDOWPOS_UNDEFINED, SDL_WINDOWPOS_UNDEFINED,
                                      (int)width, (int)height, SDL_WINDOW_RESIZABLE);
    if (!window->shown) {
        status = fail(reason, STATUS_UNSUPPORTED, "no window: creating it failed (SDL: %s)",
                      sdl->GetError());
        window_close(window);
        return status;
    }
    *out = window;
    return STATUS_OK;
}

static void take_event(struct window *window, const SDL_Event *event, struct window_news *out)
{
    SDL_Keycode key = event->key.keysym.sym;
    switch (event->type) {
    case SDL_QUIT:
        out->quit = true;
        break;
    case SDL_WINDOWEVENT:
        out->redraw = out->redraw || event->window.event == SDL_WINDOWEVENT_EXPOSED ||
                      event->window.event == SDL_WINDOWEVENT_SIZE_CHANGED;
        break;
    case SDL_KEYDOWN:
    case SDL_KEYUP: /* also sent for held keys when the window loses focus */
        if (key == SDLK_LEFT || key == SDLK_RIGHT)
            turning_key(&window->turning, key == SDLK_LEFT, event->type == SDL_KEYDOWN,
                        event->key.timestamp);
        else if (key == SDLK_ESCAPE && event->type == SDL_KEYDOWN)
            out->quit = true;
        break;
    default:
        break;
    }
}

void window_wait(struct window *window, unsigned most_ms, struct window_news *out)
{
    const struct sdl *sdl = &window->sdl;
    int width, height;
    SDL_Event event;
    *out = (struct window_news){0};
    if (most_ms > 0 && sdl->WaitEventTimeout(&event, (int)most_ms))
        take_event(window, &event, out);
    while (sdl->PollEvent(&event))
        take_event(window, &event, out);
    out->turn_ms = turning_take(&window->turning, sdl->GetTicks());
    out->turning = window->turning.left || window->turning.right;
    sdl->GetWindowSize(window->shown, &width, &height);
    out->width = (uint32_t)width;
    out->height = (uint32_t)height;
}

enum status window_show(struct window *window, const struct image *image, struct reason *reason)
{
    const struct sdl *sdl = &window->sdl;
    /* Red in bits 0-7 is SDL's ABGR. The surface is valid until the next change of size. */
    SDL_Surface *screen = sdl->GetWindowSurface(window->shown);
    SDL_Surface *picture =
        sdl->CreateRGBSurfaceWithFormatFrom(image->pixel, (int)image->width, (int)image->height, 32,
                                            (int)(4 * image->width), SDL_PIXELFORMAT_ABGR8888);
    bool fine = screen && picture && sdl->SetSurfaceBlendMode(picture, SDL_BLENDMODE_NONE) == 0 &&
                sdl->UpperBlitScaled(picture, NULL, screen, NULL) == 0 &&
                sdl->UpdateWindowSurface(window->shown) == 0;
    enum status status = STATUS_OK;
    if (!fine)
        status = fail(reason, STATUS_DEVICE, "window: the picture cannot be shown (SDL: %s)",
                      sdl->GetError());
    sdl->FreeSurface(picture); /* NULL is allowed */
    return status;
}

void window_title(struct window *window, const char *title)
{
    window->sdl.SetWindowTitle(window->shown, title);
}

void window_close(struct window *window)
{
    if (!window)
        return;
    if (window->shown)
        window->sdl.DestroyWindow(window->shown);
    window->sdl.Quit();
    free(window);
}

#else

enum status window_open(const char *title, uint32_t width, uint32_t height, struct window **out,
                        struct reason *reason)
{
    (void)title, (void)width, (void)height;
    *out = NULL;
    return fail(reason, STATUS_UNSUPPORTED, "no window: compiled without SDL2 (libsdl2-dev)");
}

/* Not called: window_open always fails. */
void window_wait(struct window *window, unsigned most_ms, struct window_news *out)
{
    (void)window, (void)most_ms;
    *out = (struct window_news){.quit = true};
}

enum status window_show(struct window *window, const struct image *image, struct reason *reason)
{
    (void)window, (void)image;
    return fail(reason, STATUS_UNSUPPORTED, "no window: compiled without SDL2 (libsdl2-dev)");
}

void window_title(struct window *window, const char *title)
{
    (void)window, (void)title;
}

void window_close(struct window *window)
{
    (void)window;
}

#endif
