-- Links of a page to other pages of the site: the README.md at the top is index.html, any other .md becomes .html.
function Link(link)
    local target, anchor = link.target:match("^([^#]*)(.*)$")
    if not target:match("^%a+:") and target:match("%.md$") then
        if target == "README.md" or target == "../README.md" then
            target = target:gsub("README", "index")
        end
        link.target = target:gsub("%.md$", ".html") .. anchor
    end
    return link
end
