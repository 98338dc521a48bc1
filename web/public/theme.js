// SPDX-License-Identifier: GPL-3.0-or-later
// Sets the theme before the first paint. app/theme.ts keeps it up to date afterwards.
(function () {
  var theme = null;
  try {
    theme = localStorage.getItem('formwright.theme');
  } catch (error) {
    // Storage may be denied; the system's theme will do.
  }
  var asked = /[?&]theme=(light|dark)/.exec(location.hash);
  if (asked) theme = asked[1];
  if (theme !== 'light' && theme !== 'dark')
    theme = matchMedia('(prefers-color-scheme: dark)').matches ? 'dark' : 'light';
  document.documentElement.dataset.theme = theme;
})();
