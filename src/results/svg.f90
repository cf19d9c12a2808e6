!> The text of an SVG picture (Scalable Vector Graphics 1.1): elements with places in pixels, from the upper left
!> corner, y down. ASCII; numbers have at most two decimals, so that equal pictures are equal bytes.
module svg
   use kinds, only: wp
   use text_output, only: output_t, put, add, replaced
   use number_format, only: fixed, whole, max_decimals
   implicit none
   private
   public :: page_t, begin_page, end_page, open_group, draw_window, close_group, draw_circle, draw_line, &
      draw_words, draw_columns, pixels, attribute, fitted

   !> A page of pictures, one below the other. Its text is held until all are drawn, since its first line has the
   !> height of the page.
   type :: page_t
      type(output_t) :: body                 !< the text of all pictures so far
      integer :: height = 0                  !< of all pictures so far (pixels)
   end type page_t

   !> The width of a page (pixels).
   integer, parameter, public :: page_width = 800
   !> The first line of a file that holds a picture.
   character(*), parameter :: xml_line = '<?xml version="1.0" encoding="US-ASCII"?>'
   !> The classes of the elements. Widths and sizes are in pixels.
   character(*), parameter :: style(*) = [character(118) :: &
      'text{font-family:"DejaVu Sans",Verdana,Arial,sans-serif;font-size:12px;fill:#222;stroke:#fff;stroke-width:3;', &
      'paint-order:stroke;stroke-linejoin:round}', &
      'text.title{font-size:14px;font-weight:bold}', &
      'text.time{font-weight:bold}', &
      'text.link{font-style:italic}', &
      'text.flag{fill:#d00000}', &
      'polyline,polygon{fill:none;stroke:#222;stroke-width:1.5;stroke-linejoin:round;stroke-linecap:round}', &
      '.faint *{stroke:#d0d4d8;stroke-width:1.2}', &
      '.body{stroke-width:2;fill-opacity:0.25}', &
      '.bar{stroke-width:7}', &
      '.barrel{stroke-width:2;fill:#fff;fill-opacity:0.85}', &
      '.piston{stroke-width:4}', &
      '.leader{stroke:#888;stroke-width:0.8}', &
      '.core{stroke-width:3.5;stroke:#fff;stroke-opacity:0.65}', &
      '.centrode{stroke-width:4;stroke-opacity:0.4}', &
      '.centre{fill:#fff;stroke-width:2}', &
      '.rod{stroke-width:5}', &
      '.slot{stroke:#fff;stroke-opacity:0.8}', &
      '.hatch{stroke-width:6;stroke-dasharray:1 6;stroke-linecap:butt}', &
      '.support{fill:#fff}', &
      '.joint{fill:#fff;stroke:#222;stroke-width:1.5}', &
      '.point{fill:#222}', &
      '.drive{stroke:#0a7a3c;stroke-width:2}', &
      '.tip{stroke:none;fill:#0a7a3c}', &
      '.arrow{stroke:#a01060;stroke-width:2}', &
      '.tip.arrow{stroke:none;fill:#a01060}']

   !> Places and overlaps that differ by no more than this (pixels) are equal: rounding errors do not choose.
   real(wp), parameter, public :: tie = 1.0e-6_wp

contains

   !> Begins the file of a page without pictures.
   subroutine begin_page(o, page)
      type(output_t), intent(inout) :: o
      type(page_t), intent(out) :: page      !< without pictures

      call put(o, xml_line)
      allocate (character(1) :: page%body%buffer)
      page%body%held = .true.
   end subroutine begin_page

   !> Writes a page to its file, with a white ground.
   subroutine end_page(o, page)
      type(output_t), intent(inout) :: o
      type(page_t), intent(in) :: page       !< with all pictures
      character(:), allocatable :: height
      integer :: i

      height = whole(max(1, page%height))
      call put(o, '<svg xmlns="http://www.w3.org/2000/svg" version="1.1" width="'//whole(page_width)//'" height="' &
         //height//'" viewBox="0 0 '//whole(page_width)//' '//height//'">')
      call put(o, '<style type="text/css">')
      do i = 1, size(style)
         call put(o, trim(style(i)))
      end do
      call put(o, '</style>')
      call put(o, '<rect width="'//whole(page_width)//'" height="'//height//'" fill="#fff"/>')
      call add(o, page%body%buffer(:page%body%used))
      call close_group(o, 'svg')
   end subroutine end_page

   !> Begins a group of elements.
   subroutine open_group(o, attributes, title)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: attributes   !< of the group
      character(*), intent(in) :: title      !< a viewer shows it; '': none

      call put(o, '<g '//attributes//'>')
      if (len(title) > 0) call put(o, '<title>'//escaped(title)//'</title>')
   end subroutine open_group

   !> Ends a group or a picture, which was begun last.
   subroutine close_group(o, element)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: element    !< 'g': a group; 'svg': a picture

      call put(o, '</'//element//'>')
   end subroutine close_group

   !> Writes a circle.
   subroutine draw_circle(o, p, radius, attributes)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: p(2)           !< pixels of its centre
      real(wp), intent(in) :: radius         !< pixels
      character(*), intent(in) :: attributes   !< of the circle

      call put(o, '<circle cx="'//pixels(p(1))//'" cy="'//pixels(p(2))//'" r="'//pixels(radius)//'" '//attributes//'/>')
   end subroutine draw_circle

   !> Writes a line through places.
   subroutine draw_line(o, element, p, attributes)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: element    !< 'polyline', or 'polygon', which closes the line
      character(*), intent(in) :: attributes   !< of the line
      real(wp), intent(in) :: p(:, :)        !< (2, places) pixels

      call draw_columns(o, element//' '//attributes//' points="', p, ',', ' ')
   end subroutine draw_line

   !> Writes words at a place.
   subroutine draw_words(o, p, anchor, attributes, words)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: p(2)           !< pixels of a point of the words' foot line
      character(*), intent(in) :: anchor     !< the place of that point on the line: 'start', 'middle' or 'end'
      character(*), intent(in) :: attributes   !< of the words
      character(*), intent(in) :: words      !< not escaped

      call put(o, '<text x="'//pixels(p(1))//'" y="'//pixels(p(2))//'" text-anchor="'//anchor//'" '//attributes//'>' &
         //escaped(words)//'</text>')
   end subroutine draw_words

   !> Writes an element whose last attribute has the columns of an array as text.
   subroutine draw_columns(o, begins, values, inside, between)
      type(output_t), intent(inout) :: o
      character(*), intent(in) :: begins     !< the element up to the quote of this attribute
      real(wp), intent(in) :: values(:, :)   !< (numbers, columns) pixels or degrees
      character(*), intent(in) :: inside     !< between the numbers of a column
      character(*), intent(in) :: between    !< between columns
      integer :: i, k

      call add(o, '<'//begins)
      do k = 1, size(values, 2)
         if (k > 1) call add(o, between)
         do i = 1, size(values, 1)
            if (i > 1) call add(o, inside)
            call add(o, pixels(values(i, k)))
         end do
      end do
      call put(o, '"/>')
   end subroutine draw_columns

   !> Begins a window: only this part of the following elements is seen, until `close_group` ends the window.
   subroutine draw_window(o, low, high)
      type(output_t), intent(inout) :: o
      real(wp), intent(in) :: low(2), high(2)   !< pixels of the upper left and the lower right corner of the window

      call put(o, '<svg x="'//pixels(low(1))//'" y="'//pixels(low(2))//'" width="'//pixels(high(1) - low(1)) &
         //'" height="'//pixels(high(2) - low(2))//'" viewBox="'//pixels(low(1))//' '//pixels(low(2))//' ' &
         //pixels(high(1) - low(1))//' '//pixels(high(2) - low(2))//'" overflow="hidden">')
   end subroutine draw_window

   !> Gives a number with at most two decimals. Half a hundredth, but for rounding errors, always goes up.
   pure function pixels(value) result(text)
      real(wp), intent(in) :: value          !< pixels or degrees
      character(:), allocatable :: text

      text = without_zeros(fixed(value + tie, 2, 0))
   end function pixels

   !> Gives a number with six digits, without zeros at their end. A negative number keeps the zero before its point.
   pure function fitted(value) result(text)
      real(wp), intent(in) :: value          !< in any unit
      character(:), allocatable :: text
      integer :: e

      e = 0
      if (abs(value) > 0.0_wp) e = floor(log10(abs(value)))
      if (abs(value) > 0.0_wp .and. (e < -4 .or. e > 5)) then
         text = without_zeros(fixed(value, 5, e))//'E'//whole(e)
      else
         text = without_zeros(fixed(value, min(5 - e, max_decimals - merge(1, 0, value < 0.0_wp)), 0))
      end if
   end function fitted

   !> Removes zeros at the end of the decimals of a number.
   pure function without_zeros(digits) result(text)
      character(*), intent(in) :: digits     !< the number
      character(:), allocatable :: text

      text = trim(adjustl(digits))
      if (index(text, '.') == 0) return
      text = text(:verify(text, '0', back=.true.))
      if (text(len(text):) == '.') text = text(:len(text) - 1)
   end function without_zeros

   !> Gives the text of an attribute.
   pure function attribute(name, value) result(text)
      character(*), intent(in) :: name       !< of the attribute
      character(*), intent(in) :: value      !< not escaped
      character(:), allocatable :: text

      text = name//'="'//escaped(value)//'"'
   end function attribute

   !> Escapes a text for XML; a character that is not printable ASCII becomes a question mark.
   pure function escaped(text) result(xml)
      character(*), intent(in) :: text       !< not escaped
      character(:), allocatable :: xml
      integer :: i

      xml = replaced(text, '&<>"', [character(6) :: '&amp;', '&lt;', '&gt;', '&quot;'])
      do i = 1, len(xml)
         if (xml(i:i) < ' ' .or. xml(i:i) > '~') xml(i:i) = '?'
      end do
   end function escaped
end module svg
