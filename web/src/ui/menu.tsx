// SPDX-License-Identifier: GPL-3.0-or-later
import type { ComponentChildren } from 'preact';
import { useEffect, useLayoutEffect, useRef, useState } from 'preact/hooks';
import type { IconName } from './icon';
import { Icon } from './icon';
import { hideTip, tipHandlers } from './tip';

interface MenuItem {
  readonly label: string;
  readonly hint?: string | undefined;
  readonly icon?: IconName;
  readonly checked?: boolean | undefined;
  readonly disabledReason?: string | undefined;
  readonly danger?: boolean;
  readonly onSelect: () => void;
}

export interface MenuProps {
  /** Spoken name of the button where its content is only a picture. */
  readonly label?: string;
  readonly title?: string;
  readonly buttonClass: string;
  readonly children: ComponentChildren;
  /** null draws a line. */
  readonly items: readonly (MenuItem | null)[];
  readonly align?: 'left' | 'right';
}

/** A button that opens a list of actions. Arrows, Home, End and letters move; Escape closes. */
export function Menu({ label, title, buttonClass, children, items, align = 'left' }: MenuProps) {
  const [open, setOpen] = useState(false);
  const button = useRef<HTMLButtonElement>(null);
  const list = useRef<HTMLDivElement>(null);
  const entries = () => [...(list.current?.querySelectorAll<HTMLElement>('[role^=menuitem]') ?? [])];

  useLayoutEffect(() => {
    if (!open || button.current === null || list.current === null) return;
    hideTip();
    const anchor = button.current.getBoundingClientRect();
    const box = list.current.getBoundingClientRect();
    const below = anchor.bottom + 4 + box.height <= window.innerHeight - 8;
    const left = align === 'right' ? anchor.right - box.width : anchor.left;
    list.current.style.left = `${Math.max(8, Math.min(left, window.innerWidth - box.width - 8))}px`;
    list.current.style.top = `${below ? anchor.bottom + 4 : Math.max(8, anchor.top - 4 - box.height)}px`;
    entries()[0]?.focus();
  }, [open]);

  useEffect(() => {
    if (!open) return undefined;
    const outside = (event: Event) => {
      const target = event.target as Node;
      if (!list.current?.contains(target) && !button.current?.contains(target)) setOpen(false);
    };
    const close = () => setOpen(false);
    document.addEventListener('pointerdown', outside, true);
    window.addEventListener('resize', close);
    return () => {
      document.removeEventListener('pointerdown', outside, true);
      window.removeEventListener('resize', close);
    };
  }, [open]);

  const close = () => {
    setOpen(false);
    button.current?.focus();
  };
  const keys = (event: KeyboardEvent) => {
    const all = entries();
    const at = all.indexOf(document.activeElement as HTMLElement);
    const go = (index: number) => all[(index + all.length) % all.length]?.focus();
    if (event.key === 'ArrowDown') go(at + 1);
    else if (event.key === 'ArrowUp') go(at - 1);
    else if (event.key === 'Home') go(0);
    else if (event.key === 'End') go(-1);
    else if (event.key === 'Escape') close();
    else if (event.key === 'Tab') setOpen(false);
    else if (/^\p{L}$/u.test(event.key) && !event.ctrlKey && !event.metaKey) {
      const after = [...all.slice(at + 1), ...all.slice(0, at + 1)];
      after
        .find((entry) => entry.textContent.trim().toLowerCase().startsWith(event.key.toLowerCase()))
        ?.focus();
    } else return;
    if (event.key !== 'Tab') event.preventDefault();
    event.stopPropagation();
  };

  return (
    <>
      <button
        ref={button}
        type="button"
        class={buttonClass}
        aria-label={label}
        aria-haspopup="menu"
        aria-expanded={open}
        onClick={() => setOpen(!open)}
        onKeyDown={(event) => {
          if (event.key !== 'ArrowDown') return;
          event.preventDefault();
          setOpen(true);
        }}
        {...tipHandlers(open ? undefined : (title ?? label))}
      >
        {children}
      </button>
      {open ? (
        <div ref={list} role="menu" class="menu" aria-label={label} onKeyDown={keys}>
          {items.map((item, index) =>
            item === null ? (
              <hr key={index} />
            ) : (
              <button
                key={item.label}
                type="button"
                role={item.checked === undefined ? 'menuitem' : 'menuitemradio'}
                aria-checked={item.checked}
                aria-disabled={item.disabledReason ? true : undefined}
                tabIndex={-1}
                class={item.danger ? 'danger' : ''}
                onClick={() => {
                  if (item.disabledReason) return;
                  close();
                  item.onSelect();
                }}
              >
                <span class="mark">
                  {item.checked ? (
                    <Icon name="check" small />
                  ) : item.icon ? (
                    <Icon name={item.icon} small />
                  ) : null}
                </span>
                <span class="grow">{item.label}</span>
                {(item.disabledReason ?? item.hint) ? (
                  <small>{item.disabledReason ?? item.hint}</small>
                ) : null}
              </button>
            ),
          )}
        </div>
      ) : null}
    </>
  );
}
