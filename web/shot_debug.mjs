import { chromium } from '@playwright/test';
const b = await chromium.launch({ executablePath:'/usr/bin/chromium', args:['--headless=new','--no-sandbox'] });
const c = await b.newContext({ viewport:{width:1280,height:800}, reducedMotion:'reduce', colorScheme:'dark' });
const p = await c.newPage();
p.on('pageerror', e=>console.log('ERR',e));
await p.goto('http://127.0.0.1:5722/');
await p.getByRole('link',{name:'Thermoform',exact:true}).click();
await p.locator('.gallery button',{hasText:process.argv[2]??'Pyramid'}).click();
const up=()=>p.locator('footer strong').getByText('Preview up to date').waitFor({timeout:120000});
await up();
async function drag(name, dx, dy, tag){
 const h = p.getByRole('button',{name}); await h.hover(); await p.waitForTimeout(1500);
 const box = await h.boundingBox(); await p.mouse.move(box.x+14,box.y+14); await p.mouse.down(); await p.mouse.move(box.x+14+dx,box.y+14+dy,{steps:4});
 await p.waitForTimeout(6000); await p.screenshot({path:`/tmp/looks/d_${tag}.png`}); await p.mouse.up(); await p.waitForTimeout(500); await up(); await p.waitForTimeout(3000); await p.screenshot({path:`/tmp/looks/d_${tag}_end.png`});
 console.log(tag, await p.getByRole('button',{name:/^Turn the model/}).getAttribute('aria-label'));
}
await drag(/^Tilt the model sideways/, 40, 40, 'side');
await drag(/^Turn the model/, 30, -60, 'turn');
await drag(/^Tilt the model to the front/, 0, 40, 'fwd');
await b.close();
