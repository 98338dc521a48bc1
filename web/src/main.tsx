// SPDX-License-Identifier: GPL-3.0-or-later
import { render } from 'preact';
import './ui/tokens.css';

const root = document.getElementById('root');
if (root) render(<p>Formwright</p>, root);
