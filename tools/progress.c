// SPDX-License-Identifier: MIT
// How far the work is. On a terminal one line is drawn again at most ten times a second:
//
//     rendering ━━━━━━━━━━━━━━━──────────  61 %  4.21 M samples/s  0:12 left
//
// as wide as the terminal allows, and it is gone when the work is done. Elsewhere (a file, a build log) a
// line is written every few seconds, at growing intervals. Always on stderr: stdout is for results.
#include "tool.h"

#include <langinfo.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <unistd.h>

#define REDRAW_SECONDS   0.1
#define FIRST_LINE_AFTER 3.0
#define LINE_SECONDS_MAX 60.0
#define MAX_BAR          40

// The one that has a line on the terminal now.
static progress *shown;

static int terminal_width(void) {
    struct winsize size;
    if (ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 0) return size.ws_col;
    return 80;
}

void progress_begin(progress *p, const char *what, const char *unit, bool quiet) {
    const char *terminal = getenv("TERM");
    *p = (progress){.what = what, .unit = unit, .quiet = quiet};
    p->on_terminal = isatty(STDERR_FILENO) && !(terminal && strcmp(terminal, "dumb") == 0);
    p->utf8 = strcmp(nl_langinfo(CODESET), "UTF-8") == 0;
    p->start = clock_seconds();
    p->interval = p->on_terminal ? REDRAW_SECONDS : FIRST_LINE_AFTER;
    p->last = p->start;
}

void progress_clear_line(void) {
    if (!shown || !shown->is_drawn) return;
    fputs("\r\033[K", stderr);
    fflush(stderr);
    shown->is_drawn = false;
}

// "0:12 left"; nothing while nobody can tell.
static void text_left(char text[TEXT_BYTES], double fraction, double elapsed) {
    text[0] = 0;
    if (!(fraction > 0.001) || elapsed < 0.5) return;
    const double left = fmin(ceil(elapsed * (1 - fraction) / fraction), 359999);
    const int seconds = (int)left;
    if (seconds >= 3600) {
        snprintf(text, TEXT_BYTES, "%d:%02d:%02d left", seconds / 3600, seconds / 60 % 60, seconds % 60);
    } else {
        snprintf(text, TEXT_BYTES, "%d:%02d left", seconds / 60, seconds % 60);
    }
}

static void draw_bar(const progress *p, double fraction, int width) {
    const int full = (int)(fraction * width);
    const char *done = p->utf8 ? "━" : "#", *rest = p->utf8 ? "─" : ".";
    if (p->utf8) fputs("\033[36m", stderr);
    for (int i = 0; i < full; i++) fputs(done, stderr);
    if (p->utf8) fputs("\033[0m\033[2m", stderr);
    for (int i = full; i < width; i++) fputs(rest, stderr);
    if (p->utf8) fputs("\033[0m", stderr);
}

static void draw_line(progress *p, double fraction, double done, double elapsed) {
    char rate[TEXT_BYTES], left[TEXT_BYTES], tail[160], percent[16] = "";
    text_rate(rate, done, elapsed, p->unit);
    text_left(left, fraction, elapsed);
    // 99.96 % is not yet 100 %.
    if (!isnan(fraction)) snprintf(percent, sizeof percent, "%3d %%  ", (int)(100 * fraction));
    snprintf(tail, sizeof tail, "%s%s  %s", percent, rate, left);
    // One column stays free: a terminal that wraps there would break the line.
    const int room = terminal_width() - 1, label = (int)strlen(p->what) + 1;
    int bar = room - label - (int)strlen(tail) - 2;
    if (bar > MAX_BAR) bar = MAX_BAR;
    shown = p;
    p->is_drawn = true;
    fputc('\r', stderr);
    if (bar >= 6 && !isnan(fraction)) {
        fprintf(stderr, "%s ", p->what);
        draw_bar(p, fraction, bar);
        fprintf(stderr, "  %s", tail);
    } else {
        if (label + (int)strlen(tail) <= room) fprintf(stderr, "%s ", p->what);
        fprintf(stderr, "%.*s", room, tail);
    }
    fputs("\033[K", stderr);
    fflush(stderr);
}

void progress_update(progress *p, double fraction, double done) {
    if (p->quiet) return;
    const double now = clock_seconds();
    if (now - p->last < p->interval) return;
    p->last = now;
    if (fraction < 0) fraction = 0;
    if (fraction > 1) fraction = 1;
    if (p->on_terminal) {
        draw_line(p, fraction, done, now - p->start);
        return;
    }
    char rate[TEXT_BYTES], left[TEXT_BYTES], count[TEXT_BYTES], percent[TEXT_BYTES];
    text_rate(rate, done, now - p->start, p->unit);
    text_left(left, fraction, now - p->start);
    if (isnan(fraction)) {
        snprintf(percent, sizeof percent, "%s %s", text_count(count, (uint64_t)done), p->unit);
    } else {
        snprintf(percent, sizeof percent, "%d %%", (int)(100 * fraction));
    }
    fprintf(stderr, "%s: %s, %s%s%s\n", p->what, percent, rate, left[0] ? ", " : "", left);
    p->interval = fmin(1.5 * p->interval, LINE_SECONDS_MAX);
}

void progress_note(progress *p, const char *text) {
    if (p->quiet || !p->on_terminal) return;
    shown = p;
    p->is_drawn = true;
    fprintf(stderr, "\r%.*s\033[K", terminal_width() - 1, text);
    fflush(stderr);
}

void progress_end(progress *p) {
    progress_clear_line();
    if (shown == p) shown = NULL;
}
